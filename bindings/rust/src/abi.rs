// SPDX-License-Identifier: MIT
//! `smartvis_plugin.h` and the extensions of `smartvis/*.h`, under their own names. What a field means, its unit, its owner and
//! its thread stand there. build.rs writes structs and constants (`header.rs`), and `tests/headers.rs` holds them to the C headers.
use crate::layout::{constants, structs};
use std::ffi::{c_void, CStr};
use std::os::raw::c_char;

pub type sv_status = i32;

/// OpenCL's own types, behind pointers only.
#[repr(C)]
pub struct _cl_context([u8; 0]);
#[repr(C)]
pub struct _cl_device_id([u8; 0]);
#[repr(C)]
pub struct _cl_command_queue([u8; 0]);
#[repr(C)]
pub struct _cl_mem([u8; 0]);

include!(concat!(env!("OUT_DIR"), "/header.rs"));

// A descriptor and the texts that it points to are constant.
unsafe impl Sync for sv_descriptor {}

const fn text(bytes: &'static [u8]) -> &'static CStr {
    // Safety: every caller ends its bytes with their only zero.
    unsafe { CStr::from_bytes_with_nul_unchecked(bytes) }
}

/// The bit of a carrier or a voxel type in a descriptor.
pub const fn sv_bit(value: u32) -> u32 {
    1 << value
}
