// SPDX-License-Identifier: MIT
//! `smartvis_plugin.h` and the extensions of `smartvis/*.h`, under their own names. What a field means, its unit, its owner and
//! its thread stand there. `tests/headers.rs` holds all of it to the C headers.
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

structs! {
    layouts;
    /// What a host offers.
    struct sv_host {
        size: u32,
        abi_minor: u32,
        host_data: *mut c_void,
        name: *const c_char,
        version: *const c_char,
        log: Option<unsafe extern "C" fn(host: *const sv_host, severity: i32, text: *const c_char)>,
        get_extension: Option<unsafe extern "C" fn(host: *const sv_host, id: *const c_char) -> *const c_void>,
    }
    /// A parameter, described for a host.
    struct sv_param_info {
        size: u32,
        id: u32,
        r#type: u32,
        flags: u32,
        key: *const c_char,
        label: *const c_char,
        unit: *const c_char,
        help: *const c_char,
        min_value: f64,
        max_value: f64,
        display_min: f64,
        display_max: f64,
        default_value: f64,
        step: f64,
        group: *const c_char,
        depends_on: u32,
        reserved: u32,
        depends_values: u64,
    }
    /// A parameter's value.
    struct sv_param_value {
        id: u32,
        reserved: u32,
        value: f64,
    }
    /// What stays the same from frame to frame.
    struct sv_format {
        size: u32,
        width: u32,
        height: u32,
        slices: u32,
        max_slab_slices: u32,
        voxel_type: u32,
        carrier: u32,
        padding_value: i32,
        tiles_x: u32,
        tile_w: u32,
        tile_h: u32,
        row_pitch: u32,
        spacing_mm: [f32; 3],
        flags: u32,
        context: *mut _cl_context,
        device: *mut _cl_device_id,
        queue: *mut _cl_command_queue,
        host_memory: *const c_void,
        host_memory_bytes: u64,
        values: *const sv_param_value,
        value_count: u32,
        reserved: u32,
    }
    /// The slices of a ray that were scanned: first .. end - 1.
    struct sv_scanned {
        first: u16,
        end: u16,
    }
    /// What begin reads.
    struct sv_frame {
        size: u32,
        flags: u32,
        index: u64,
        time_ns: u64,
        values: *const sv_param_value,
        value_count: u32,
        reserved: u32,
        scanned: *const sv_scanned,
        scanned_object: *mut _cl_mem,
        scanned_offset: u64,
        probe_rotation: [f32; 9],
        probe_side: [f32; 3],
        beams: u32,
        beam_apex_mm: [f32; 3],
        beam_sweep_mm: f32,
        reserved_beams: u32,
    }
    /// A run of slices.
    struct sv_slab {
        size: u32,
        first_slice: u32,
        slice_count: u32,
        reserved: u32,
        memory: *const c_void,
        object: *mut _cl_mem,
        offset: u64,
        bytes: u64,
    }
    /// What a frame came to.
    struct sv_stats {
        size: u32,
        outcome: sv_status,
        rays: u32,
        points: u32,
        unfilled: u32,
    }
    /// Where results go.
    struct sv_result {
        size: u32,
        depth_pitch: u32,
        depth: *mut f32,
        depth_object: *mut _cl_mem,
        depth_offset: u64,
        status: *mut u8,
        stats: *mut sv_stats,
    }
    /// What a plugin is, and what it can do.
    struct sv_descriptor {
        size: u32,
        carriers: u32,
        id: *const c_char,
        name: *const c_char,
        vendor: *const c_char,
        version: *const c_char,
        summary: *const c_char,
        voxel_types: u32,
        queues: u32,
        features: u32,
        reserved: u32,
        extensions: *const *const c_char,
    }
    /// An instance.
    struct sv_plugin {
        size: u32,
        reserved: u32,
        descriptor: *const sv_descriptor,
        plugin_data: *mut c_void,
        destroy: unsafe extern "C" fn(plugin: *const sv_plugin),
        activate: unsafe extern "C" fn(plugin: *const sv_plugin, format: *const sv_format) -> sv_status,
        deactivate: unsafe extern "C" fn(plugin: *const sv_plugin),
        begin: unsafe extern "C" fn(plugin: *const sv_plugin, frame: *const sv_frame) -> sv_status,
        slab: unsafe extern "C" fn(plugin: *const sv_plugin, slab: *const sv_slab) -> sv_status,
        end: unsafe extern "C" fn(plugin: *const sv_plugin, result: *const sv_result) -> sv_status,
        adjust: unsafe extern "C" fn(plugin: *const sv_plugin, values: *const sv_param_value, value_count: u32, result: *const sv_result) -> sv_status,
        param_count: unsafe extern "C" fn(plugin: *const sv_plugin) -> u32,
        param_info: unsafe extern "C" fn(plugin: *const sv_plugin, index: u32, out: *mut sv_param_info) -> sv_status,
        param_text: unsafe extern "C" fn(plugin: *const sv_plugin, id: u32, value: f64, out: *mut c_char, bytes: u32) -> sv_status,
        last_error: unsafe extern "C" fn(plugin: *const sv_plugin) -> *const c_char,
        get_extension: unsafe extern "C" fn(plugin: *const sv_plugin, id: *const c_char) -> *const c_void,
    }
    /// What a library exports.
    struct sv_entry {
        abi_major: u32,
        abi_minor: u32,
        size: u32,
        count: u32,
        descriptor: unsafe extern "C" fn(index: u32) -> *const sv_descriptor,
        create: unsafe extern "C" fn(host: *const sv_host, id: *const c_char, out: *mut *const sv_plugin) -> sv_status,
    }
    /// Why there is no surface.
    struct sv_confidence_report {
        size: u32,
        fluid_threshold: f32,
        rays: u32,
        open_rays: u32,
        reason: u32,
        found: f32,
        wanted: f32,
        try_id: u32,
        try_value: f32,
    }
    /// The table of smartvis.confidence/1.
    struct sv_ext_confidence {
        size: u32,
        reserved: u32,
        read: unsafe extern "C" fn(plugin: *const sv_plugin, map: *mut f32, out: *mut sv_confidence_report) -> sv_status,
        offered: unsafe extern "C" fn(plugin: *const sv_plugin) -> u32,
        write: unsafe extern "C" fn(plugin: *const sv_plugin, map: *mut f32, object: *mut _cl_mem, offset: u64) -> sv_status,
    }
    /// A device to be.
    struct sv_needs_device {
        size: u32,
        flags: u32,
        compute_units: u32,
        reserved: u32,
    }
    /// What an activation takes.
    struct sv_needs {
        size: u32,
        commands: u32,
        adjust_commands: u32,
        reserved: u32,
        device_bytes: u64,
        largest_buffer: u64,
        host_bytes: u64,
    }
    /// The table of smartvis.needs/1.
    struct sv_ext_needs {
        size: u32,
        reserved: u32,
        of: unsafe extern "C" fn(plugin: *const sv_plugin, format: *const sv_format, values: *const sv_param_value, value_count: u32, device: *const sv_needs_device, out: *mut sv_needs) -> sv_status,
    }
    /// What initial points came to.
    struct sv_points_report {
        size: u32,
        empty_points: u32,
        passes: u32,
        volume_max: f32,
        bone_threshold: f32,
        sure_points: u32,
    }
    /// The table of smartvis.points/1.
    struct sv_ext_points {
        size: u32,
        reserved: u32,
        write: unsafe extern "C" fn(plugin: *const sv_plugin, out: *mut sv_points_report) -> sv_status,
    }
    /// What the spline came to.
    struct sv_spline_report {
        size: u32,
        points: u32,
        merge_grid: u32,
        rank: u32,
        dropped: u32,
        condition: f32,
        residual: f32,
        reserved: u32,
    }
    /// The table of smartvis.spline/1.
    struct sv_ext_spline {
        size: u32,
        reserved: u32,
        report: unsafe extern "C" fn(plugin: *const sv_plugin, out: *mut sv_spline_report) -> sv_status,
    }
    /// Milliseconds by stage.
    struct sv_stage_times {
        size: u32,
        reserved: u32,
        transfer_ms: f64,
        profile_ms: f64,
        threshold_ms: f64,
        reconstruct_ms: f64,
        output_ms: f64,
    }
    /// The table of smartvis.timing/1.
    struct sv_ext_timing {
        size: u32,
        reserved: u32,
        enable: unsafe extern "C" fn(plugin: *const sv_plugin, on: u32) -> sv_status,
        stage_times: unsafe extern "C" fn(plugin: *const sv_plugin, out: *mut sv_stage_times) -> sv_status,
    }
}

// A descriptor and the texts that it points to are constant.
unsafe impl Sync for sv_descriptor {}

constants! {
    i32 {
        SV_OK = 0,
        SV_NO_SURFACE = 1,
        SV_PARTIAL = 2,
        SV_ERR_INTERNAL = -1,
        SV_ERR_ARGUMENT = -10,
        SV_ERR_SIZE = -11,
        SV_ERR_FORMAT = -12,
        SV_ERR_PARAM_ID = -13,
        SV_ERR_PARAM_RANGE = -14,
        SV_ERR_PARAM_FIXED = -15,
        SV_ERR_UNKNOWN_ID = -16,
        SV_ERR_STATE = -20,
        SV_ERR_SLAB_ORDER = -21,
        SV_ERR_SLAB_MISSING = -22,
        SV_ERR_SLAB_SHAPE = -23,
        SV_ERR_NO_DEVICE = -30,
        SV_ERR_BUILD = -31,
        SV_ERR_OPENCL = -32,
        SV_ERR_SELF_TEST = -33,
        SV_ERR_NO_MEMORY = -40,
        SV_LOG_DEBUG = 0,
        SV_LOG_INFO = 1,
        SV_LOG_WARNING = 2,
        SV_LOG_ERROR = 3,
        SV_LOG_HOST_MISBEHAVING = 4,
        SV_LOG_PLUGIN_MISBEHAVING = 5,
        SV_NO_PADDING = -1,
    }
    u8 {
        SV_POINT_NONE = 0,
        SV_POINT_INITIAL = 1,
        SV_POINT_EMPTY = 2,
    }
    u32 {
        SV_ABI_MAJOR = 1,
        SV_ABI_MINOR = 1,
        SV_PARAM_FLOAT = 0,
        SV_PARAM_INT = 1,
        SV_PARAM_BOOL = 2,
        SV_PARAM_ENUM = 3,
        SV_PARAM_PRIMARY = 1 << 0,
        SV_PARAM_EXPERT = 1 << 1,
        SV_PARAM_REACTIVATE = 1 << 2,
        SV_PARAM_ADJUST = 1 << 3,
        SV_VOXEL_U8 = 1,
        SV_VOXEL_U16 = 2,
        SV_CARRIER_HOST = 1,
        SV_CARRIER_BUFFER = 2,
        SV_CARRIER_IMAGE = 3,
        SV_FORMAT_SCANNED = 1 << 0,
        SV_FRAME_DISCONTINUITY = 1 << 0,
        SV_FRAME_SAME_VOLUME = 1 << 1,
        SV_BEAMS_UNKNOWN = 0,
        SV_BEAMS_PARALLEL = 1,
        SV_BEAMS_FAN = 2,
        SV_QUEUE_OWN = 1 << 0,
        SV_QUEUE_HOST = 1 << 1,
        SV_FEATURE_SCANNED = 1 << 0,
        SV_FEATURE_PADDING = 1 << 1,
        SV_FEATURE_ADJUST = 1 << 2,
        SV_FEATURE_PROBE = 1 << 3,
        SV_REASON_NONE = 0,
        SV_REASON_NO_FLUID = 1,
        SV_REASON_EMPTY = 2,
        SV_REASON_NO_FETUS = 3,
        SV_REASON_DOUBTFUL = 4,
        SV_NEEDS_CPU = 1 << 0,
        SV_NEEDS_UNIFIED = 1 << 1,
        SV_NEEDS_DOUBLES = 1 << 2,
    }
}

pub const SV_ASSUMED_EXTENT_MM: f32 = 120.0;

const fn text(bytes: &'static [u8]) -> &'static CStr {
    // Safety: every caller ends its bytes with their only zero.
    unsafe { CStr::from_bytes_with_nul_unchecked(bytes) }
}

pub const SV_ENTRY_SYMBOL: &CStr = text(b"smartvis_plugin_entry\0");
pub const SV_EXT_CONFIDENCE: &CStr = text(b"smartvis.confidence/1\0");
pub const SV_EXT_NEEDS: &CStr = text(b"smartvis.needs/1\0");
pub const SV_EXT_POINTS: &CStr = text(b"smartvis.points/1\0");
pub const SV_EXT_SPLINE: &CStr = text(b"smartvis.spline/1\0");
pub const SV_EXT_TIMING: &CStr = text(b"smartvis.timing/1\0");

/// The bit of a carrier or a voxel type in a descriptor.
pub const fn sv_bit(value: u32) -> u32 {
    1 << value
}
