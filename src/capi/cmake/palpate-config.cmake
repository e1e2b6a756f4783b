# find_package(palpate) gives palpate::palpate (shared) and palpate::static, each with its headers.
#
#     PREFIX/include/palpate.h, palpate.hpp     PREFIX/lib/libpalpate_capi.*     PREFIX/lib/cmake/palpate/palpate-config.cmake
get_filename_component(_palpate_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

find_library(_palpate_shared NAMES palpate_capi palpate_capi.dll PATHS "${_palpate_prefix}/lib" NO_DEFAULT_PATH)
find_file(_palpate_static NAMES libpalpate_capi.a palpate_capi.lib PATHS "${_palpate_prefix}/lib" NO_DEFAULT_PATH)

if(_palpate_shared AND NOT TARGET palpate::palpate)
    add_library(palpate::palpate UNKNOWN IMPORTED)
    set_target_properties(palpate::palpate PROPERTIES
        IMPORTED_LOCATION "${_palpate_shared}"
        INTERFACE_INCLUDE_DIRECTORIES "${_palpate_prefix}/include"
        INTERFACE_COMPILE_FEATURES cxx_std_17)
endif()

if(_palpate_static AND NOT TARGET palpate::static)
    find_package(Threads REQUIRED)
    add_library(palpate::static STATIC IMPORTED)
    set_target_properties(palpate::static PROPERTIES
        IMPORTED_LOCATION "${_palpate_static}"
        INTERFACE_INCLUDE_DIRECTORIES "${_palpate_prefix}/include"
        INTERFACE_COMPILE_FEATURES cxx_std_17
        INTERFACE_LINK_LIBRARIES "Threads::Threads;${CMAKE_DL_LIBS};$<$<PLATFORM_ID:Linux>:m>;$<$<PLATFORM_ID:Windows>:ntdll;userenv;ws2_32>")
endif()

if(NOT TARGET palpate::palpate AND NOT TARGET palpate::static)
    set(palpate_FOUND FALSE)
    set(palpate_NOT_FOUND_MESSAGE "no libpalpate_capi in ${_palpate_prefix}/lib; src/capi/install.sh puts it there")
endif()
