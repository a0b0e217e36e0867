include(CMakeFindDependencyMacro)
find_dependency(OpenCL)
include(${CMAKE_CURRENT_LIST_DIR}/bvhbench-targets.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/BvhbenchBuilder.cmake)
