# SPDX-License-Identifier: MIT OR Apache-2.0
# hole.c with the bhr of the folder above: cmake -S examples -B build && cmake --build build. The program finds bhr.dll
# beside itself, where it is copied to.
cmake_minimum_required(VERSION 3.14)
project(hole C)
find_package(bhr REQUIRED PATHS "${CMAKE_CURRENT_SOURCE_DIR}/../lib/cmake/bhr" NO_DEFAULT_PATH)
add_executable(hole hole.c)
target_link_libraries(hole PRIVATE bhr::bhr)
add_custom_command(TARGET hole POST_BUILD
    COMMAND "${CMAKE_COMMAND}" -E copy_if_different $<TARGET_FILE:bhr::bhr> $<TARGET_FILE_DIR:hole>)
