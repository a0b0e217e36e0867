# The Debian package that `cpack -G DEB` makes in a build folder from the installed files. It
# depends on the libraries that the files are linked with (dpkg-shlibdeps); any OpenCL ICD can be
# the driver.
set(CPACK_PACKAGE_NAME bvhbench)
set(CPACK_PACKAGE_VENDOR "the authors of bvhbench")
set(CPACK_PACKAGE_CONTACT "the authors of bvhbench <bvhbench@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "pocl-opencl-icd | opencl-icd, gnuplot-nox | gnuplot")
# for plug-ins
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "build-essential, cmake, ocl-icd-opencl-dev, opencl-headers")
include(CPack)
