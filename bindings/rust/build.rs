// SPDX-License-Identifier: MIT
//! Writes the headers' structs and constants as Rust, and compiles smartvis/author.h for plugins. Its folder is $SMARTVIS_INCLUDE, or where this crate lies in a checkout or an
//! installation, or what pkg-config says.
mod header;

use std::env::var;
use std::path::PathBuf;
use std::process::Command;

fn run(command: &mut Command) {
    let ended = command.status();
    assert!(matches!(&ended, Ok(status) if status.success()), "{:?}: {:?}", command, ended);
}

fn from_pkg_config() -> Option<PathBuf> {
    let out = Command::new("pkg-config").args(["--variable=includedir", "smartvis-plugin"]).output().ok()?;
    // Blanks come escaped.
    Some(PathBuf::from(String::from_utf8(out.stdout).ok()?.trim().replace("\\ ", " ")))
}

fn main() {
    let here = PathBuf::from(var("CARGO_MANIFEST_DIR").unwrap());
    let folders = [
        var("SMARTVIS_INCLUDE").ok().map(PathBuf::from),
        Some(here.join("../../include")),
        Some(here.join("../../../../include")),
        from_pkg_config(),
    ];
    let include = folders
        .into_iter()
        .flatten()
        .find(|folder| folder.join("smartvis/author.h").exists())
        .expect("no smartvis/author.h found: set SMARTVIS_INCLUDE to the folder of smartvis_plugin.h");
    let out = PathBuf::from(var("OUT_DIR").unwrap());
    let names = [
        "smartvis_plugin",
        "smartvis/confidence",
        "smartvis/needs",
        "smartvis/points",
        "smartvis/timing",
    ];
    let headers = names.map(|name| include.join(name.to_string() + ".h"));
    let texts: Vec<String> = headers.iter().map(|header| std::fs::read_to_string(header).unwrap()).collect();
    std::fs::write(out.join("header.rs"), header::rust_of(&texts)).unwrap();
    headers.iter().for_each(|header| println!("cargo:rerun-if-changed={}", header.display()));
    let compiler = var("CC").unwrap_or_else(|_| "cc".into());
    run(Command::new(compiler)
        .args(["-std=c11", "-O2", "-Wall", "-Wextra", "-fPIC", "-c", "src/author.c", "-I"])
        .arg(&include)
        .arg("-o")
        .arg(out.join("author.o")));
    run(Command::new("ar").arg("crs").arg(out.join("libsmartvis_author.a")).arg(out.join("author.o")));
    println!("cargo:rustc-link-search=native={}", out.display());
    println!("cargo:rustc-link-lib=static=smartvis_author");
    println!("cargo:rustc-env=SMARTVIS_INCLUDE={}", include.display());
    println!("cargo:rerun-if-env-changed=SMARTVIS_INCLUDE");
    println!("cargo:rerun-if-changed=src/author.c");
}
