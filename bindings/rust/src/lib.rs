// SPDX-License-Identifier: MIT
//! SmartVis plugins and hosts in Rust. [`abi`] is the C header, [`author`] what a plugin needs beside its method; a host calls
//! the functions of [`abi::sv_plugin`], as `examples/small_host.rs` does.
#![allow(non_camel_case_types)]

pub mod abi;
pub mod author;
#[doc(hidden)]
pub mod layout;

/// A struct of the ABI with its size set, and the rest 0.
pub trait OfSize: Copy {
    fn sized() -> Self;
}

macro_rules! sized {
    ($($name:ident)*) => {
        $(impl OfSize for abi::$name {
            fn sized() -> Self {
                // Safety: numbers and pointers, which may be 0.
                let mut out: Self = unsafe { std::mem::zeroed() };
                out.size = std::mem::size_of::<Self>() as u32;
                out
            }
        })*
    };
}

sized!(sv_host sv_param_info sv_format sv_frame sv_slab sv_stats sv_result sv_confidence_report sv_needs_device sv_needs
       sv_points_report sv_stage_times);
