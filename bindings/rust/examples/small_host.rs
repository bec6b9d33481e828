// SPDX-License-Identifier: MIT
//! A host in Rust. It shows the volume of the C example of this name to a plugin on its own queue and prints the same lines.
use smartvis::abi::*;
use smartvis::OfSize;
use std::ffi::{c_void, CStr, CString};
use std::os::raw::{c_char, c_int};

const SIDE: usize = 64;
const SLICES: usize = 64;
const SLAB: usize = 16;
const RAYS: usize = SIDE * SIDE;

#[link(name = "dl")]
extern "C" {
    fn dlopen(path: *const c_char, flags: c_int) -> *mut c_void;
    fn dlsym(library: *mut c_void, name: *const c_char) -> *const c_void;
    fn dlerror() -> *const c_char;
}

fn make_volume() -> Vec<u8> {
    let mut volume = vec![0u8; SLICES * RAYS];
    for i in 0..RAYS {
        let x = i % SIDE;
        let near = 8 + x / 16;
        let far = near + 20 + (x / 8 + i / SIDE / 8) % 4;
        for z in 0..SLICES {
            volume[z * RAYS + i] = if z < near {
                100
            } else if z < far {
                10
            } else {
                200
            };
        }
    }
    volume
}

/// An instance, which is destroyed with it.
struct Instance(*const sv_plugin);

impl Drop for Instance {
    fn drop(&mut self) {
        // Safety: create gave it, and nothing else destroys it.
        unsafe { ((*self.0).destroy)(self.0) }
    }
}

/// An instance between activate and deactivate.
struct Active<'a>(&'a Instance);

impl Drop for Active<'_> {
    fn drop(&mut self) {
        // Safety: activate has succeeded.
        unsafe { ((*(self.0).0).deactivate)((self.0).0) }
    }
}

fn make_format(ranges: bool) -> sv_format {
    sv_format {
        width: SIDE as u32,
        height: SIDE as u32,
        slices: SLICES as u32,
        max_slab_slices: SLAB as u32,
        voxel_type: SV_VOXEL_U8,
        carrier: SV_CARRIER_HOST,
        padding_value: SV_NO_PADDING,
        tiles_x: 1,
        tile_w: SIDE as u32,
        tile_h: SIDE as u32,
        row_pitch: SIDE as u32,
        spacing_mm: [1.0; 3],
        flags: if ranges { SV_FORMAT_SCANNED } else { 0 },
        ..sv_format::sized()
    }
}

/// A negative status is an error.
fn check(status: sv_status) -> Result<sv_status, sv_status> {
    if status < SV_OK {
        Err(status)
    } else {
        Ok(status)
    }
}

/// One volume, front to back, with every parameter at its default. Returns the outcome.
fn one_frame(instance: &Instance, depth: &mut [f32]) -> Result<sv_status, sv_status> {
    let volume = make_volume();
    let scanned = vec![sv_scanned { first: 0, end: (SLICES - 4) as u16 }; RAYS];
    let p = instance.0;
    // Safety: all memory that the structs point to outlives the calls, and is as long as they say.
    unsafe {
        let ranges = (*(*p).descriptor).features & SV_FEATURE_SCANNED != 0;
        check(((*p).activate)(p, &make_format(ranges)))?;
        let _active = Active(instance);
        let scanned = if ranges { scanned.as_ptr() } else { std::ptr::null() };
        check(((*p).begin)(p, &sv_frame { index: 1, scanned, ..sv_frame::sized() }))?;
        for z in (0..SLICES).step_by(SLAB) {
            let slab = sv_slab {
                first_slice: z as u32,
                slice_count: SLAB as u32,
                memory: volume[z * RAYS..].as_ptr().cast(),
                bytes: (RAYS * SLAB) as u64,
                ..sv_slab::sized()
            };
            check(((*p).slab)(p, &slab))?;
        }
        check(((*p).end)(p, &sv_result { depth: depth.as_mut_ptr(), ..sv_result::sized() }))
    }
}

unsafe extern "C" fn print_log(_host: *const sv_host, severity: i32, text: *const c_char) {
    if severity >= SV_LOG_WARNING {
        eprintln!("plugin: {}", CStr::from_ptr(text).to_string_lossy());
    }
}

/// The entry of a library, which stays loaded.
fn load(path: &str) -> Result<&'static sv_entry, String> {
    let file = CString::new(path).map_err(|e| e.to_string())?;
    // Safety: the symbol of a plugin is an sv_entry; of another major version only the version is read.
    let entry = unsafe {
        let library = dlopen(file.as_ptr(), 2);
        if library.is_null() {
            return Err(CStr::from_ptr(dlerror()).to_string_lossy().into_owned());
        }
        (dlsym(library, SV_ENTRY_SYMBOL.as_ptr()) as *const sv_entry).as_ref()
    };
    let entry = entry.ok_or_else(|| format!("{path}: is no plugin"))?;
    if entry.abi_major == SV_ABI_MAJOR {
        Ok(entry)
    } else {
        Err(format!("{path}: its ABI is {}", entry.abi_major))
    }
}

fn main() {
    let path = std::env::args().nth(1).unwrap_or_else(|| {
        eprintln!("usage: small_host FOLDER/PLUGIN.so");
        std::process::exit(2)
    });
    let entry = load(&path).unwrap_or_else(|why| {
        eprintln!("small_host: {why}");
        std::process::exit(4)
    });
    let name = CString::new("small_host").unwrap();
    let host = sv_host {
        abi_minor: SV_ABI_MINOR,
        name: name.as_ptr(),
        version: name.as_ptr(),
        log: Some(print_log),
        ..sv_host::sized()
    };
    let mut depth = vec![0f32; RAYS];
    let mut p: *const sv_plugin = std::ptr::null();
    // Safety: a library has a first plugin, and `host` outlives the instance.
    let (id, created) = unsafe {
        let id = (*(entry.descriptor)(0)).id;
        (CStr::from_ptr(id), (entry.create)(&host, id, &mut p))
    };
    let outcome = check(created).and_then(|_| one_frame(&Instance(p), &mut depth));
    let clip = matches!(outcome, Ok(SV_OK | SV_PARTIAL)); // else unclipped, never with an old map
    let status = outcome.unwrap_or_else(|error| error);
    println!("{}: status {status}, rendered {}", id.to_string_lossy(), if clip { "with the map" } else { "unclipped" });
    for y in (4..SIDE).step_by(8) {
        for x in (4..SIDE).step_by(8) {
            let d = if clip { depth[y * SIDE + x] } else { 0.0 };
            print!("{d:5.1}{}", if x > SIDE - 8 { '\n' } else { ' ' });
        }
    }
    std::process::exit(if status < SV_OK { 4 } else { 0 });
}
