# SPDX-License-Identifier: MIT OR Apache-2.0
# find_package(bhr) of an installed bhr. Gives the targets bhr::bhr, the shared library, and bhr::static, for those of
# the two that are there. Everything is found from this file's own place, so that the prefix may be moved: the file
# lies in <libdir>/cmake/bhr, or in <prefix>/share/<any folders>.
get_filename_component(bhr_prefix "${CMAKE_CURRENT_LIST_DIR}" REALPATH)
get_filename_component(bhr_libdir "${bhr_prefix}/../.." ABSOLUTE)
foreach(bhr_level RANGE 6)
    if(EXISTS "${bhr_prefix}/include/bhr.h")
        break()
    endif()
    get_filename_component(bhr_prefix "${bhr_prefix}" DIRECTORY)
endforeach()
if(NOT EXISTS "${bhr_prefix}/include/bhr.h")
    set(bhr_FOUND FALSE)
    set(bhr_NOT_FOUND_MESSAGE "no include/bhr.h in the folders above ${CMAKE_CURRENT_LIST_DIR}")
    return()
endif()

foreach(bhr_kind IN ITEMS SHARED STATIC)
    set(bhr_target bhr::bhr)
    if(bhr_kind STREQUAL STATIC)
        set(bhr_target bhr::static)
    endif()
    set(bhr_name "${CMAKE_${bhr_kind}_LIBRARY_PREFIX}bhr${CMAKE_${bhr_kind}_LIBRARY_SUFFIX}")
    foreach(bhr_folder IN ITEMS "${bhr_libdir}" "${bhr_prefix}/lib" "${bhr_prefix}/lib64"
            "${bhr_prefix}/lib/${CMAKE_LIBRARY_ARCHITECTURE}" "${bhr_prefix}/bin")
        if(NOT TARGET ${bhr_target} AND EXISTS "${bhr_folder}/${bhr_name}")
            add_library(${bhr_target} ${bhr_kind} IMPORTED)
            set_target_properties(${bhr_target} PROPERTIES
                IMPORTED_LOCATION "${bhr_folder}/${bhr_name}"
                INTERFACE_INCLUDE_DIRECTORIES "${bhr_prefix}/include")
        endif()
    endforeach()
endforeach()
if(TARGET bhr::bhr AND WIN32)
    set_target_properties(bhr::bhr PROPERTIES IMPORTED_IMPLIB "${bhr_prefix}/lib/bhr.dll.lib")
endif()
# The system libraries of Rust's standard library; on Windows and macOS "rustc --print native-static-libs" says them.
if(TARGET bhr::static AND UNIX AND NOT APPLE)
    set_target_properties(bhr::static PROPERTIES INTERFACE_LINK_LIBRARIES "gcc_s;util;rt;pthread;m;dl")
endif()
if(NOT TARGET bhr::bhr AND NOT TARGET bhr::static)
    set(bhr_FOUND FALSE)
    set(bhr_NOT_FOUND_MESSAGE "no library of bhr beside ${CMAKE_CURRENT_LIST_DIR}")
endif()
foreach(bhr_variable IN ITEMS prefix libdir level kind name target folder variable)
    unset(bhr_${bhr_variable})
endforeach()
