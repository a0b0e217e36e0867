# Optimises a plug-in unless its author says otherwise, since it is compared with optimised
# builders.
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Kind of build" FORCE)
endif()
include(CMakeFindDependencyMacro)
find_dependency(OpenCL)
include(${CMAKE_CURRENT_LIST_DIR}/bvhbench-targets.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/BvhbenchBuilder.cmake)
