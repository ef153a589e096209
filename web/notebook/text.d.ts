// SPDX-License-Identifier: MIT OR Apache-2.0
// text.d.ts -- files that the bundle holds as text.

declare module "*.txt" {
    const text: string;
    export default text;
}
