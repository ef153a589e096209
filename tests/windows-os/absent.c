/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/* absent.c -- a host asks for a backend whose DLL of Windows may be absent, and goes on by the CPU.
 *
 *     absent BACKEND DLL there|absent         whether the system has the DLL
 *
 * Where it is absent there is no adapter. Where it is there a context may come of it or not, as Wine's compiler of
 * shaders does not take all that Windows' does; a refusal has a status and a message, and is no bug of bhr's. Asked
 * twice, as what was found or missed the first time is remembered.
 */
#include "../c/check.h"

#include <stdio.h>
#include <string.h>
#include <windows.h>

int main(int argc, char **argv) {
    if (argc != 4) return 2;
    BhrBackend backend = check_begin(argc, argv);
    int        absent = !strcmp(argv[3], "absent");
    HMODULE    dll = LoadLibraryA(argv[2]);
    CHECK((dll == NULL) == absent, "%s is %s", argv[2], dll ? "there" : "absent");
    if (dll) FreeLibrary(dll);
    for (int i = 0; i < 2; i++) {
        BhrContextOptions options = check_options(backend);
        BhrContext       *context = NULL;
        BhrStatus         status = bhr_context_create(BHR_ABI_VERSION, &options, &context);
        printf("%s: %s\n", bhr_status_name(status), status < 0 ? bhr_error_message() : "a context");
        if (absent) {
            CHECK(status == BHR_ERROR_NO_ADAPTER, "%s", bhr_status_name(status));
        } else {
            CHECK(status == BHR_OK || status == BHR_ERROR_NO_ADAPTER || status == BHR_ERROR_UNSUPPORTED, "%s",
                  bhr_status_name(status));
        }
        CHECK((status == BHR_OK) == (context != NULL), "a context that is none");
        CHECK(status == BHR_OK || *bhr_error_message() != 0, "no message");
        bhr_context_destroy(context);
    }
    bhr_context_destroy(check_context(BHR_BACKEND_CPU));
    return check_end();
}
