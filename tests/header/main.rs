// SPDX-License-Identifier: MIT OR Apache-2.0
//! The library's outside: the header, the contract and releases before this one, the symbols, and the notices of what
//! is linked. Traces nothing; needs a C and a C++ compiler.

mod abi;
mod bindings;
mod c_header;
mod contract;
mod example_fields;
mod field_list;
mod generated;
mod init;
mod json;
mod layouts;
mod model;
mod new_field;
mod prose;
mod python_structs;
mod ranges;
mod symbols;
mod third_party;
mod typescript;
