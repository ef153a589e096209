# SPDX-License-Identifier: MIT OR Apache-2.0
# An overlay port of vcpkg for Linux, which installs the repository that it lies in. Checked by
#
#     vcpkg install bhr --overlay-ports=packaging/vcpkg
#
# vcpkg itself was never run on it; tests/run all runs this file with stand-ins for vcpkg's functions, and a host by
# find_package(bhr). Needs cargo. The release library serves debug builds as well: it has no debug form in C.
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set(VCPKG_BUILD_TYPE release)
set(VCPKG_POLICY_MISMATCHED_NUMBER_OF_BINARIES enabled)

set(kind --static --no-shared)
if(VCPKG_LIBRARY_LINKAGE STREQUAL dynamic)
    set(kind "")
endif()
vcpkg_execute_required_process(
    COMMAND "${CMAKE_COMMAND}" -E env "CARGO_TARGET_DIR=${CURRENT_BUILDTREES_DIR}/cargo"
        "${SOURCE_PATH}/install" "--prefix=${CURRENT_PACKAGES_DIR}" --destdir= ${kind} $ENV{BHR_INSTALL}
    WORKING_DIRECTORY "${SOURCE_PATH}"
    LOGNAME install)

# vcpkg's places: CMake's files in share/<port>, and the licences in one file beside them.
file(GLOB config_files "${CURRENT_PACKAGES_DIR}/lib/cmake/bhr/*.cmake")
file(COPY ${config_files} DESTINATION "${CURRENT_PACKAGES_DIR}/share/bhr")
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/lib/cmake" "${CURRENT_PACKAGES_DIR}/share/doc")
file(REMOVE "${CURRENT_PACKAGES_DIR}/share/bhr/install-manifest.txt")
vcpkg_fixup_pkgconfig()
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE-MIT" "${SOURCE_PATH}/LICENSE-APACHE"
    "${SOURCE_PATH}/THIRD-PARTY.txt")
