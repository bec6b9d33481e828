// SPDX-License-Identifier: MIT
//! A plugin made by `plugin!`, called as a host calls it: what its method sees and gives, and that a panic ends the frame only.
use smartvis::abi::*;
use smartvis::author::{Volume, NO_DEPTH};
use smartvis::OfSize;
use std::ffi::CStr;

const WIDTH: u32 = 3;
const TILE: u32 = 5;
const FAILS: u32 = 7;

/// The sum of the scanned voxels of a ray, each times its slice; none of them: no surface.
fn sums(volume: &Volume, depth: &mut [f32]) -> sv_status {
    assert!(volume.value(FAILS) == 0.0, "as asked for");
    for (x, pixel) in (0..WIDTH).zip(depth) {
        let sum: u32 = volume.ray(x, 0).map(|(slice, voxel)| slice * u32::from(voxel)).sum();
        *pixel = if sum > 0 { sum as f32 } else { NO_DEPTH };
    }
    SV_OK
}

smartvis::plugin!(
    "org.smartvis.test.sums",
    "Sums",
    "SmartVis tests",
    "1.0.0",
    "A test.",
    SV_FEATURE_SCANNED | SV_FEATURE_PADDING,
    [smartvis::param!(FAILS, SV_PARAM_BOOL, 0, "fails", "Fails", "", "The method panics.", 0.0, 1.0, 0.0, 1.0)],
    crate::sums
);

extern "C" {
    static smartvis_plugin_entry: sv_entry;
}

/// Two slices side by side, of one row. Ray 0 is whole, of ray 1 slice 1 was scanned, ray 2 has the padding value.
unsafe fn frame(p: *const sv_plugin, fails: f64, depth: &mut [f32; WIDTH as usize]) -> sv_status {
    let voxels: [u8; 2 * TILE as usize] = [10, 20, 99, 0, 0, 30, 40, 99, 0, 0];
    let scanned = [sv_scanned { first: 0, end: 9 }, sv_scanned { first: 1, end: 2 }, sv_scanned { first: 0, end: 2 }];
    let values = [sv_param_value { id: FAILS, reserved: 0, value: fails }];
    let begun = ((*p).begin)(
        p,
        &sv_frame { scanned: scanned.as_ptr(), values: values.as_ptr(), value_count: 1, ..sv_frame::sized() },
    );
    assert_eq!(begun, SV_OK);
    let slab =
        sv_slab { slice_count: 2, memory: voxels.as_ptr().cast(), bytes: voxels.len() as u64, ..sv_slab::sized() };
    assert_eq!(((*p).slab)(p, &slab), SV_OK);
    ((*p).end)(p, &sv_result { depth: depth.as_mut_ptr(), ..sv_result::sized() })
}

#[test]
fn a_plugin_does_what_its_method_does() {
    let name = b"test\0".as_ptr().cast();
    let host = sv_host { name, version: name, ..sv_host::sized() };
    let format = sv_format {
        width: WIDTH,
        height: 1,
        slices: 2,
        max_slab_slices: 2,
        voxel_type: SV_VOXEL_U8,
        carrier: SV_CARRIER_HOST,
        padding_value: 99,
        tiles_x: 2,
        tile_w: TILE,
        tile_h: 1,
        row_pitch: 2 * TILE,
        flags: SV_FORMAT_SCANNED,
        ..sv_format::sized()
    };
    let mut p: *const sv_plugin = std::ptr::null();
    let mut depth = [0.0; WIDTH as usize];
    // Safety: the calls of a host, in their order, with memory that outlives them.
    unsafe {
        assert_eq!((smartvis_plugin_entry.create)(&host, (*(smartvis_plugin_entry.descriptor)(0)).id, &mut p), SV_OK);
        assert_eq!(((*p).activate)(p, &format), SV_OK);
        assert_eq!(frame(p, 0.0, &mut depth), SV_PARTIAL);
        assert_eq!(depth, [30.0, 40.0, 0.0]);
        assert_eq!(frame(p, 1.0, &mut depth), SV_ERR_INTERNAL);
        assert!(!CStr::from_ptr(((*p).last_error)(p)).to_bytes().is_empty());
        assert_eq!(frame(p, 0.0, &mut depth), SV_PARTIAL, "after a panic the instance goes on");
        ((*p).deactivate)(p);
        ((*p).destroy)(p);
    }
}
