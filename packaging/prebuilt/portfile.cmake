# SPDX-License-Identifier: MIT OR Apache-2.0
# An overlay port of vcpkg for Windows on x86-64, of the prebuilt zip: packaging/windows-packages of bhr's repository
# has filled in its place and checksum. The release library serves debug builds as well: it has no debug form in C.
# vcpkg itself was never run on it.
vcpkg_check_linkage(ONLY_DYNAMIC_LIBRARY)
set(VCPKG_BUILD_TYPE release)
set(VCPKG_POLICY_MISMATCHED_NUMBER_OF_BINARIES enabled)

vcpkg_download_distfile(archive
    URLS "@URL@"
    FILENAME "@FILE@"
    SHA512 @SHA512@)
vcpkg_extract_source_archive(package ARCHIVE "${archive}")

# vcpkg's places: CMake's files in share/<port>, and the licences in one file beside them.
file(GLOB config_files "${package}/lib/cmake/bhr/*.cmake")
file(COPY ${config_files} "${package}/share/bhr/bhr.json" DESTINATION "${CURRENT_PACKAGES_DIR}/share/bhr")
file(COPY "${package}/include" DESTINATION "${CURRENT_PACKAGES_DIR}")
file(COPY "${package}/bin/bhr.dll" DESTINATION "${CURRENT_PACKAGES_DIR}/bin")
set(import_library bhr.lib)
if(VCPKG_TARGET_IS_MINGW)
    set(import_library libbhr.dll.a)
endif()
file(COPY "${package}/lib/${import_library}" "${package}/lib/pkgconfig" DESTINATION "${CURRENT_PACKAGES_DIR}/lib")
vcpkg_fixup_pkgconfig()
vcpkg_install_copyright(FILE_LIST "${package}/share/doc/bhr/LICENSE-MIT" "${package}/share/doc/bhr/LICENSE-APACHE"
    "${package}/share/doc/bhr/THIRD-PARTY.txt")
