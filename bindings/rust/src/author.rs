// SPDX-License-Identifier: MIT
//! Plugins in Rust: `smartvis/author.h` does everything but the method, compiled by `build.rs`. A method is a function that sees
//! a whole volume; `plugin!` makes the library's entry of it.
use crate::abi::*;
use crate::layout::structs;
use std::ffi::c_void;
use std::os::raw::{c_char, c_long};
use std::panic::{catch_unwind, AssertUnwindSafe};

structs! {
    layouts;
    /// One row of a method's parameters.
    struct sva_param {
        id: u32,
        r#type: u32,
        flags: u32,
        key: *const c_char,
        label: *const c_char,
        unit: *const c_char,
        help: *const c_char,
        min_value: f64,
        max_value: f64,
        default_value: f64,
        step: f64,
        display_min: f64,
        display_max: f64,
        group: *const c_char,
        names: *const *const c_char,
        depends_on: u32,
        depends_values: u64,
    }
    /// A plugin as its author writes it.
    struct sva_method {
        descriptor: *const sv_descriptor,
        params: *const sva_param,
        param_count: u32,
        own_bytes: usize,
        ray_bytes: usize,
        activate: Option<unsafe extern "C" fn(a: *mut sva) -> sv_status>,
        deactivate: Option<unsafe extern "C" fn(a: *mut sva)>,
        begin: Option<unsafe extern "C" fn(a: *mut sva) -> sv_status>,
        slab: Option<unsafe extern "C" fn(a: *mut sva, slab: *const sv_slab) -> sv_status>,
        finish: Option<unsafe extern "C" fn(a: *mut sva, depth: *mut f32) -> sv_status>,
        adjust: Option<unsafe extern "C" fn(a: *mut sva, depth: *mut f32) -> sv_status>,
        output: Option<unsafe extern "C" fn(a: *mut sva, result: *const sv_result) -> sv_status>,
        extension: Option<unsafe extern "C" fn(a: *const sva, id: *const c_char) -> *const c_void>,
        abandon: Option<unsafe extern "C" fn(a: *mut sva)>,
        depends_values: Option<unsafe extern "C" fn(param: *const sva_param) -> u64>,
    }
    /// An instance as its method sees it.
    struct sva {
        api: sv_plugin,
        method: *const sva_method,
        host: *const sv_host,
        own: *mut c_void,
        rays: *mut c_void,
        format: sv_format,
        padding: i32,
        frame: sv_frame,
        scanned: *const sv_scanned,
        slice: *mut *const u8,
        depth: *mut f32,
        points: *mut u8,
        stats: sv_stats,
        values: *mut f64,
        framed: *mut f64,
        fixed: *mut f64,
        next_slice: u32,
        state: u32,
        reason: [c_char; 512],
        doubted: i32,
        busy: c_long,
    }
}

// Tables of constants.
unsafe impl Sync for sva_param {}
unsafe impl Sync for sva_method {}

extern "C" {
    /// `sva_create` of author.h.
    pub fn smartvis_author_create(
        method: *const sva_method,
        host: *const sv_host,
        id: *const c_char,
        out: *mut *const sv_plugin,
    ) -> sv_status;
}

/// A depth for pixels without a surface.
pub const NO_DEPTH: f32 = -f32::MAX;

/// The volume of a frame, and the values of its parameters.
pub struct Volume<'a>(&'a sva);

impl Volume<'_> {
    pub fn format(&self) -> &sv_format {
        &self.0.format
    }

    /// The value of a parameter in this frame; 0 if there is none with this id.
    pub fn value(&self, id: u32) -> f64 {
        // Safety: author.h keeps a value for every row of the method's table.
        let rows =
            unsafe { std::slice::from_raw_parts((*self.0.method).params, (*self.0.method).param_count as usize) };
        rows.iter().position(|row| row.id == id).map_or(0.0, |i| unsafe { *self.0.values.add(i) })
    }

    /// The scanned voxels of a ray from front to back, with their slices.
    pub fn ray(&self, x: u32, y: u32) -> impl Iterator<Item = (u32, u8)> + '_ {
        let f = &self.0.format;
        assert!(x < f.width && y < f.height, "ray ({}, {}) of {} x {}", x, y, f.width, f.height);
        // Safety: all slices have come, and author.h has checked how far each may be read.
        let voxel = move |z: u32| unsafe {
            *(*self.0.slice.add(z as usize)).add(y as usize * f.row_pitch as usize + x as usize)
        };
        let range = unsafe { self.0.scanned.as_ref().map(|_| *self.0.scanned.add((y * f.width + x) as usize)) };
        let (first, end) = range.map_or((0, f.slices), |r| (r.first.into(), f.slices.min(r.end.into())));
        (first..end).map(move |z| (z, voxel(z))).filter(move |&(_, v)| i32::from(v) != self.0.padding)
    }
}

/// Runs a method; a panic becomes an error of the frame.
///
/// # Safety
/// For `plugin!` only: `a` and `depth` are what author.h hands to a method's `finish`.
pub unsafe fn run(a: *mut sva, depth: *mut f32, method: fn(&Volume, &mut [f32]) -> sv_status) -> sv_status {
    let rays = (*a).format.width as usize * (*a).format.height as usize;
    let map = std::slice::from_raw_parts_mut(depth, rays);
    catch_unwind(AssertUnwindSafe(|| method(&Volume(&*a), map))).unwrap_or(SV_ERR_INTERNAL)
}

/// A row of the table of parameters, without group: `param!(1, SV_PARAM_FLOAT, 0, "key", "Label", "unit", "Help.", minimum, maximum,
/// default, step)`.
#[macro_export]
macro_rules! param {
    ($id:expr, $type:expr, $flags:expr, $key:literal, $label:literal, $unit:literal, $help:literal, $minimum:expr, $maximum:expr, $default:expr, $step:expr) => {
        $crate::author::sva_param {
            id: $id,
            r#type: $type,
            flags: $flags,
            key: concat!($key, "\0").as_ptr().cast(),
            label: concat!($label, "\0").as_ptr().cast(),
            unit: concat!($unit, "\0").as_ptr().cast(),
            help: concat!($help, "\0").as_ptr().cast(),
            min_value: $minimum,
            max_value: $maximum,
            default_value: $default,
            step: $step,
            display_min: 0.0,
            display_max: 0.0,
            group: std::ptr::null(),
            names: std::ptr::null(),
            depends_on: 0,
            depends_values: 0,
        }
    };
}

/// Exports a plugin on the CPU, the library's only one: its texts, `SV_FEATURE_*`, its table of parameters, and its method,
/// `fn(&Volume, &mut [f32]) -> sv_status`, which fills the depthmap row by row.
#[macro_export]
macro_rules! plugin {
    ($id:literal, $name:literal, $vendor:literal, $version:literal, $summary:literal, $features:expr, $params:expr, $method:path) => {
        const _: () = {
            use $crate::abi::*;
            use $crate::author::*;
            struct NoIds([*const std::os::raw::c_char; 1]);
            unsafe impl Sync for NoIds {}
            static EXTENSIONS: NoIds = NoIds([std::ptr::null()]);
            static DESCRIPTOR: sv_descriptor = sv_descriptor {
                size: std::mem::size_of::<sv_descriptor>() as u32,
                carriers: sv_bit(SV_CARRIER_HOST),
                id: concat!($id, "\0").as_ptr().cast(),
                name: concat!($name, "\0").as_ptr().cast(),
                vendor: concat!($vendor, "\0").as_ptr().cast(),
                version: concat!($version, "\0").as_ptr().cast(),
                summary: concat!($summary, "\0").as_ptr().cast(),
                voxel_types: sv_bit(SV_VOXEL_U8),
                queues: SV_QUEUE_OWN,
                features: $features,
                reserved: 0,
                extensions: EXTENSIONS.0.as_ptr(),
            };
            static PARAMS: &[sva_param] = &$params;
            static METHOD: sva_method = sva_method {
                descriptor: &DESCRIPTOR,
                params: PARAMS.as_ptr(),
                param_count: PARAMS.len() as u32,
                own_bytes: 0,
                ray_bytes: 0,
                activate: None,
                deactivate: None,
                begin: None,
                slab: None,
                finish: Some(finish),
                adjust: None,
                output: None,
                extension: None,
                abandon: None,
                depends_values: None,
            };
            unsafe extern "C" fn finish(a: *mut sva, depth: *mut f32) -> sv_status {
                run(a, depth, $method)
            }
            unsafe extern "C" fn descriptor(index: u32) -> *const sv_descriptor {
                if index == 0 {
                    &DESCRIPTOR
                } else {
                    std::ptr::null()
                }
            }
            unsafe extern "C" fn create(
                host: *const sv_host,
                id: *const std::os::raw::c_char,
                out: *mut *const sv_plugin,
            ) -> sv_status {
                smartvis_author_create(&METHOD, host, id, out)
            }
            #[no_mangle]
            #[allow(non_upper_case_globals)]
            pub static smartvis_plugin_entry: sv_entry = sv_entry {
                abi_major: SV_ABI_MAJOR,
                abi_minor: SV_ABI_MINOR,
                size: std::mem::size_of::<sv_entry>() as u32,
                count: 1,
                descriptor,
                create,
            };
        };
    };
}
