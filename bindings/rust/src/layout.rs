// SPDX-License-Identifier: MIT
//! Declares structs and constants, and remembers what it has declared: a test compares that with the C headers.

/// A struct's name and bytes, and of every field name, offset and bytes.
pub struct Layout {
    pub name: &'static str,
    pub bytes: usize,
    pub fields: Vec<(&'static str, usize, usize)>,
}

pub fn bytes_behind<T>(_: *const T) -> usize {
    std::mem::size_of::<T>()
}

macro_rules! structs {
    ($list:ident; $($(#[$doc:meta])* struct $name:ident { $($field:ident: $type:ty,)* })*) => {
        $($(#[$doc])*
        #[repr(C)]
        #[derive(Clone, Copy)]
        pub struct $name { $(pub $field: $type,)* })*

        #[doc(hidden)]
        pub fn $list() -> Vec<$crate::layout::Layout> {
            vec![$({
                let one = std::mem::MaybeUninit::<$name>::uninit();
                let at: *const $name = one.as_ptr();
                $crate::layout::Layout {
                    name: stringify!($name),
                    bytes: std::mem::size_of::<$name>(),
                    // Safety: no field is read, only its address taken.
                    fields: vec![$(unsafe {
                        let field = std::ptr::addr_of!((*at).$field);
                        (stringify!($field).trim_start_matches("r#"), field as usize - at as usize, $crate::layout::bytes_behind(field))
                    }),*],
                }
            }),*]
        }
    };
}

macro_rules! constants {
    ($($type:ident { $($name:ident = $value:expr,)* })*) => {
        $($(pub const $name: $type = $value;)*)*

        #[doc(hidden)]
        pub const CONSTANTS: &[(&str, i64)] = &[$($((stringify!($name), $name as i64)),*),*];
    };
}

pub(crate) use {constants, structs};
