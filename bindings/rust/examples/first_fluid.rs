// SPDX-License-Identifier: MIT
//! A plugin in Rust: on every ray the surface lies in the first fluid behind the first tissue.
use smartvis::abi::*;
use smartvis::author::{Volume, NO_DEPTH};

const Q: u32 = 1;
const LEVEL: u32 = 2;

fn surface(volume: &Volume, depth: &mut [f32]) -> sv_status {
    let (q, level) = (volume.value(Q) as f32, 255.0 * volume.value(LEVEL));
    let (width, height) = (volume.format().width, volume.format().height);
    for (pixel, (x, y)) in depth.iter_mut().zip((0..height).flat_map(|y| (0..width).map(move |x| (x, y)))) {
        let dark = |&(_, voxel): &(u32, u8)| f64::from(voxel) < level;
        let mut ray = volume.ray(x, y).skip_while(dark).skip_while(|voxel| !dark(voxel));
        let near = ray.next();
        let far = ray.find(|voxel| !dark(voxel));
        *pixel = match (near, far) {
            (Some((near, _)), Some((far, _))) => far as f32 - 0.5 - q * (far - near) as f32,
            _ => NO_DEPTH,
        };
    }
    SV_OK
}

smartvis::plugin!(
    "org.smartvis.example.first_fluid",
    "First fluid",
    "SmartVis examples",
    "1.0.0",
    "The first fluid on every ray.",
    SV_FEATURE_SCANNED | SV_FEATURE_PADDING,
    [
        smartvis::param!(
            Q,
            SV_PARAM_FLOAT,
            SV_PARAM_PRIMARY,
            "q",
            "Surface position",
            "",
            "0: at the fetus; 1: at the tissue before it.",
            0.0,
            1.0,
            0.25,
            0.01
        ),
        smartvis::param!(
            LEVEL,
            SV_PARAM_FLOAT,
            0,
            "level",
            "Fluid level",
            "",
            "Darker voxels are fluid.",
            0.0,
            1.0,
            0.2,
            0.01
        )
    ],
    crate::surface
);
