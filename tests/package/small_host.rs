// SPDX-License-Identifier: MIT
//! A host in Rust, without bindings of any kind: the structs of smartvis_plugin.h, written down with `repr(C)`. It shows the
//! volume of examples/small_host to a plugin on its own queue and prints the same lines.
use std::ffi::{c_char, c_int, c_void, CStr, CString};

const SIDE: usize = 64;
const SLICES: usize = 64;
const SLAB: usize = 16;
const RAYS: usize = SIDE * SIDE;

#[repr(C)]
struct Host {
    size: u32,
    abi_minor: u32,
    host_data: *mut c_void,
    name: *const c_char,
    version: *const c_char,
    log: Option<unsafe extern "C" fn(*const Host, i32, *const c_char)>,
    get_extension: Option<unsafe extern "C" fn(*const Host, *const c_char) -> *const c_void>,
}

#[repr(C)]
struct Descriptor {
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

#[repr(C)]
#[derive(Clone, Copy)]
struct Scanned {
    first: u16,
    end: u16,
}

#[repr(C)]
struct Format {
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
    context: *mut c_void,
    device: *mut c_void,
    queue: *mut c_void,
    host_memory: *const c_void,
    host_memory_bytes: u64,
    values: *const c_void,
    value_count: u32,
    reserved: u32,
}

#[repr(C)]
struct Frame {
    size: u32,
    flags: u32,
    index: u64,
    time_ns: u64,
    values: *const c_void,
    value_count: u32,
    reserved: u32,
    scanned: *const Scanned,
    scanned_object: *mut c_void,
    scanned_offset: u64,
}

#[repr(C)]
struct Slab {
    size: u32,
    first_slice: u32,
    slice_count: u32,
    reserved: u32,
    memory: *const c_void,
    object: *mut c_void,
    offset: u64,
    bytes: u64,
}

#[repr(C)]
struct Outcome {
    size: u32,
    depth_pitch: u32,
    depth: *mut f32,
    depth_object: *mut c_void,
    depth_offset: u64,
    status: *mut u8,
    stats: *mut c_void,
}

#[repr(C)]
struct Plugin {
    size: u32,
    reserved: u32,
    descriptor: *const Descriptor,
    plugin_data: *mut c_void,
    destroy: unsafe extern "C" fn(*const Plugin),
    activate: unsafe extern "C" fn(*const Plugin, *const Format) -> i32,
    deactivate: unsafe extern "C" fn(*const Plugin),
    begin: unsafe extern "C" fn(*const Plugin, *const Frame) -> i32,
    slab: unsafe extern "C" fn(*const Plugin, *const Slab) -> i32,
    end: unsafe extern "C" fn(*const Plugin, *const Outcome) -> i32,
}

#[repr(C)]
struct Entry {
    abi_major: u32,
    abi_minor: u32,
    size: u32,
    count: u32,
    descriptor: unsafe extern "C" fn(u32) -> *const Descriptor,
    create: unsafe extern "C" fn(*const Host, *const c_char, *mut *const Plugin) -> i32,
}

#[link(name = "dl")]
extern "C" {
    fn dlopen(path: *const c_char, flags: c_int) -> *mut c_void;
    fn dlsym(library: *mut c_void, name: *const c_char) -> *const c_void;
}

fn size_of<T>() -> u32 {
    std::mem::size_of::<T>() as u32
}

fn make_volume() -> Vec<u8> {
    let mut volume = vec![0u8; SLICES * RAYS];
    for i in 0..RAYS {
        let x = i % SIDE;
        let near = 8 + x / 16;
        let far = near + 20 + (x / 8 + i / SIDE / 8) % 4;
        for z in 0..SLICES {
            volume[z * RAYS + i] = if z < near { 100 } else if z < far { 10 } else { 200 };
        }
    }
    volume
}

/// Safety: `p` is an instance that create gave.
unsafe fn one_frame(p: *const Plugin, depth: &mut [f32]) -> i32 {
    let volume = make_volume();
    let scanned = vec![Scanned { first: 0, end: (SLICES - 4) as u16 }; RAYS];
    let ranges = (*(*p).descriptor).features & 1 != 0;
    let format = Format {
        size: size_of::<Format>(),
        width: SIDE as u32,
        height: SIDE as u32,
        slices: SLICES as u32,
        max_slab_slices: SLAB as u32,
        voxel_type: 1,
        carrier: 1,
        padding_value: -1,
        tiles_x: 1,
        tile_w: SIDE as u32,
        tile_h: SIDE as u32,
        row_pitch: SIDE as u32,
        spacing_mm: [1.0; 3],
        flags: ranges as u32,
        ..std::mem::zeroed()
    };
    let mut status = ((*p).activate)(p, &format);
    if status < 0 {
        return status;
    }
    let frame = Frame {
        size: size_of::<Frame>(),
        index: 1,
        scanned: if ranges { scanned.as_ptr() } else { std::ptr::null() },
        ..std::mem::zeroed()
    };
    status = ((*p).begin)(p, &frame);
    for z in (0..SLICES).step_by(SLAB) {
        let slab = Slab {
            size: size_of::<Slab>(),
            first_slice: z as u32,
            slice_count: SLAB as u32,
            memory: volume[z * RAYS..].as_ptr().cast(),
            bytes: (RAYS * SLAB) as u64,
            ..std::mem::zeroed()
        };
        if status >= 0 {
            status = ((*p).slab)(p, &slab);
        }
    }
    let result = Outcome { size: size_of::<Outcome>(), depth: depth.as_mut_ptr(), ..std::mem::zeroed() };
    if status >= 0 {
        status = ((*p).end)(p, &result);
    }
    ((*p).deactivate)(p);
    status
}

fn main() {
    let path = CString::new(std::env::args().nth(1).expect("usage: small_host FOLDER/PLUGIN.so")).unwrap();
    let symbol = CString::new("smartvis_plugin_entry").unwrap();
    let name = CString::new("rust_host").unwrap();
    let mut depth = vec![0f32; RAYS];
    // Safety: the library is a plugin, and the structs are those of ABI 1.0, whose layout the major version names.
    let (id, status) = unsafe {
        let library = dlopen(path.as_ptr(), 2);
        assert!(!library.is_null(), "not a library: {path:?}");
        let entry = dlsym(library, symbol.as_ptr()) as *const Entry;
        assert!(!entry.is_null() && (*entry).abi_major == 1, "not a plugin of ABI 1");
        let id = (*((*entry).descriptor)(0)).id;
        let host = Host { size: size_of::<Host>(), name: name.as_ptr(), version: name.as_ptr(), ..std::mem::zeroed() };
        let mut p: *const Plugin = std::ptr::null();
        let mut status = ((*entry).create)(&host, id, &mut p);
        if status == 0 {
            status = one_frame(p, &mut depth);
            ((*p).destroy)(p);
        }
        (CStr::from_ptr(id).to_string_lossy().into_owned(), status)
    };
    let clip = status == 0 || status == 2;
    println!("{id}: status {status}, rendered {}", if clip { "with the map" } else { "unclipped" });
    for y in (4..SIDE).step_by(8) {
        for x in (4..SIDE).step_by(8) {
            let d = if clip { depth[y * SIDE + x] } else { 0.0 };
            print!("{d:5.1}{}", if x > SIDE - 8 { '\n' } else { ' ' });
        }
    }
    std::process::exit(if status < 0 { 4 } else { 0 });
}
