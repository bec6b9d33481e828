// SPDX-License-Identifier: MIT
//! The crate says what the C headers say: a C program prints every struct and constant as its compiler sees them.
use smartvis::layout::Layout;
use smartvis::{abi, author};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

const INCLUDE: &str = env!("SMARTVIS_INCLUDE");

/// The headers that the crate has: the core, the extensions, and author.h's types.
fn headers() -> Vec<PathBuf> {
    let folder = Path::new(INCLUDE).join("smartvis");
    let mut all = vec![Path::new(INCLUDE).join("smartvis_plugin.h"), folder.join("author_method.h")];
    for file in std::fs::read_dir(folder).unwrap() {
        let file = file.unwrap().path();
        if std::fs::read_to_string(&file).unwrap().contains("#define SV_EXT_") {
            all.push(file);
        }
    }
    all
}

/// A header without its comments.
fn text_of(header: &Path) -> String {
    let text = std::fs::read_to_string(header).unwrap();
    text.split("/*").enumerate().map(|(i, part)| if i == 0 { part } else { part.split_once("*/").unwrap().1 }).collect()
}

fn structs() -> Vec<Layout> {
    let mut all = abi::layouts();
    all.extend(author::layouts());
    all
}

/// What the C program prints for this crate's lists.
fn expected() -> String {
    let mut lines = String::new();
    for s in structs() {
        writeln!(lines, "{} {}", s.name, s.bytes).unwrap();
        for (field, offset, bytes) in s.fields {
            writeln!(lines, "{}.{field} {offset} {bytes}", s.name).unwrap();
        }
    }
    for (name, value) in abi::CONSTANTS {
        writeln!(lines, "{name} {value}").unwrap();
    }
    for (name, value) in texts() {
        writeln!(lines, "{name} {value}").unwrap();
    }
    lines
}

fn texts() -> Vec<(&'static str, &'static str)> {
    let all = [
        ("SV_ENTRY_SYMBOL", abi::SV_ENTRY_SYMBOL),
        ("SV_EXT_CONFIDENCE", abi::SV_EXT_CONFIDENCE),
        ("SV_EXT_NEEDS", abi::SV_EXT_NEEDS),
        ("SV_EXT_POINTS", abi::SV_EXT_POINTS),
        ("SV_EXT_TIMING", abi::SV_EXT_TIMING),
    ];
    all.iter().map(|(name, value)| (*name, value.to_str().unwrap())).collect()
}

/// A C program that prints the same lists.
fn program() -> String {
    let mut c = String::from("#include <stdio.h>\n");
    for header in headers() {
        writeln!(c, "#include \"{}\"", header.display()).unwrap();
    }
    c += "int main(void) {\n";
    for s in structs() {
        writeln!(c, "printf(\"{0} %zu\\n\", sizeof({0}));", s.name).unwrap();
        for (field, ..) in s.fields {
            writeln!(
                c,
                "printf(\"{0}.{field} %zu %zu\\n\", offsetof({0}, {field}), sizeof((({0} *)0)->{field}));",
                s.name
            )
            .unwrap();
        }
    }
    for (name, _) in abi::CONSTANTS {
        writeln!(c, "printf(\"{name} %lld\\n\", (long long){name});").unwrap();
    }
    for (name, _) in texts() {
        writeln!(c, "printf(\"{name} %s\\n\", {name});").unwrap();
    }
    c + "return 0;\n}\n"
}

#[test]
fn every_struct_and_constant_is_that_of_c() {
    let folder = std::env::temp_dir().join(format!("smartvis_layout_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (source, binary) = (folder.join("layout.c"), folder.join("layout"));
    std::fs::write(&source, program()).unwrap();
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    let built = Command::new(compiler).arg("-I").arg(INCLUDE).arg(&source).arg("-o").arg(&binary).status().unwrap();
    let printed = Command::new(&binary).output();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(built.success());
    let printed = String::from_utf8(printed.unwrap().stdout).unwrap();
    for (ours, theirs) in expected().lines().zip(printed.lines()) {
        assert_eq!(ours, theirs);
    }
    assert_eq!(expected().lines().count(), printed.lines().count());
}

#[test]
fn nothing_of_the_headers_is_left_out() {
    let known: BTreeSet<String> = structs()
        .iter()
        .map(|s| s.name)
        .chain(abi::CONSTANTS.iter().map(|c| c.0))
        .chain(texts().iter().map(|t| t.0))
        // These are written otherwise in Rust, or serve C only.
        .chain(["SV_ASSUMED_EXTENT_MM", "SV_FRAME_SIZE_1_0", "SV_CALL", "SV_EXPORT", "sv_reason"])
        .map(String::from)
        .collect();
    let mut seen = 0;
    for header in headers() {
        for line in text_of(&header).lines() {
            let words: Vec<&str> =
                line.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|w| !w.is_empty()).collect();
            let declares = |word: &str| {
                line.contains(&format!("{word} ="))
                    || line.contains(&format!("#define {word} "))
                    || line.contains(&format!("struct {word} {{"))
            };
            for word in words.iter().filter(|w| (w.starts_with("SV_") || w.starts_with("sv_")) && declares(w)) {
                assert!(known.contains(*word), "{} has {word}, and the crate does not", header.display());
                seen += 1;
            }
        }
    }
    assert!(seen > 80, "{seen} names found in the headers");
}

#[test]
fn a_number_is_that_of_c() {
    let text = text_of(&Path::new(INCLUDE).join("smartvis_plugin.h"));
    assert!(text.contains(&format!("#define SV_ASSUMED_EXTENT_MM {:.1}f", abi::SV_ASSUMED_EXTENT_MM)));
}
