// SPDX-License-Identifier: MIT
//! The C headers as Rust: build.rs writes what src/abi.rs includes. It knows as much C as the headers have, and stops at any more.
use std::fmt::Write;

fn without_comments(text: &str) -> String {
    text.split("/*").enumerate().map(|(i, part)| if i == 0 { part } else { part.split_once("*/").unwrap().1 }).collect()
}

/// A name and its type of a declaration: "const char *const *extensions", "float side[3]".
fn declaration(text: &str) -> (String, String) {
    let text = text.trim();
    let (text, array) =
        text.strip_suffix(']').map_or((text, None), |t| t.split_once('[').map(|(t, n)| (t, Some(n))).unwrap());
    let at = text.rfind(|c: char| !c.is_alphanumeric() && c != '_').expect(text) + 1;
    let kind = array.map_or(rust_type(&text[..at]), |n| format!("[{}; {n}]", rust_type(&text[..at])));
    (text[at..].into(), kind)
}

fn rust_type(text: &str) -> String {
    let mut levels = text.split('*');
    let words: Vec<&str> = levels.next().unwrap().split_whitespace().filter(|word| *word != "struct").collect();
    let base = words.iter().find(|word| **word != "const").expect(text);
    let mut kind = match *base {
        "void" => "c_void",
        "char" => "c_char",
        "float" => "f32",
        "double" => "f64",
        "uint8_t" => "u8",
        "uint16_t" => "u16",
        "int32_t" => "i32",
        "uint32_t" => "u32",
        "uint64_t" => "u64",
        other => other,
    }
    .to_string();
    let mut constant = words.contains(&"const");
    for level in levels {
        kind = format!("{} {kind}", if constant { "*const" } else { "*mut" });
        constant = level.contains("const");
    }
    kind
}

/// A field; a function's has "(SV_CALL *name)(arguments)". A host may leave its own out.
fn field(of: &str, text: &str, out: &mut String) {
    if let Some((returns, rest)) = text.split_once("(SV_CALL *") {
        let (name, rest) = rest.split_once(")(").unwrap();
        let arguments: Vec<String> = rest
            .trim_end_matches(')')
            .split(',')
            .map(declaration)
            .map(|(name, kind)| format!("{name}: {kind}"))
            .collect();
        let returns = if returns.trim() == "void" { String::new() } else { format!(" -> {}", rust_type(returns)) };
        let function = format!("unsafe extern \"C\" fn({}){returns}", arguments.join(", "));
        let function = if of == "sv_host" { format!("Option<{function}>") } else { function };
        writeln!(out, "        {name}: {function},").unwrap();
        return;
    }
    let mut names = text.split(',');
    let (first, kind) = declaration(names.next().unwrap());
    for name in std::iter::once(first.as_str()).chain(names.map(str::trim)) {
        writeln!(out, "        {}: {kind},", if name == "type" { "r#type" } else { name }).unwrap();
    }
}

fn constant(name: &str, value: &str, lists: &mut [String; 3], rest: &mut String) {
    let value = value.trim().trim_matches(|c| "()".contains(c)).replace("1u", "1");
    let signed = ["SV_OK", "SV_NO_", "SV_PARTIAL", "SV_ERR_", "SV_LOG_"].iter().any(|start| name.starts_with(start));
    if let Some(text) = value.strip_prefix('"') {
        writeln!(rest, "pub const {name}: &CStr = text(b\"{}\\0\");", text.trim_end_matches('"')).unwrap();
    } else if let Some(number) = value.strip_suffix('f') {
        writeln!(rest, "pub const {name}: f32 = {number};").unwrap();
    } else {
        let list = if signed { 0 } else { 1 + usize::from(!name.starts_with("SV_POINT_")) };
        writeln!(lists[list], "        {name} = {value},").unwrap();
    }
}

pub fn rust_of(headers: &[String]) -> String {
    let (mut structs, mut lists, mut rest) = (String::new(), <[String; 3]>::default(), String::new());
    for header in headers {
        let text = without_comments(header);
        for line in text.lines().filter_map(|line| line.strip_prefix("#define SV_")) {
            let (name, value) = line.split_once(' ').unwrap_or((line, ""));
            if !name.contains('(') && !["CALL", "EXPORT", "FRAME_SIZE_1_0"].contains(&name) {
                constant(&format!("SV_{name}"), value, &mut lists, &mut rest);
            }
        }
        let mut blocks = text.split('{');
        let mut head = blocks.next().unwrap();
        for block in blocks {
            let (body, tail) = match block.split_once('}') {
                Some(parts) => parts,
                None => {
                    head = block;
                    continue;
                }
            };
            let words: Vec<&str> = head.rsplit([';', '\n']).next().unwrap().split_whitespace().collect();
            if words.contains(&"enum") {
                for pair in body.split(',').filter(|pair| !pair.trim().is_empty()) {
                    let (name, value) = pair.split_once('=').unwrap();
                    constant(name.trim(), value, &mut lists, &mut rest);
                }
            } else if words.contains(&"struct") {
                let name = words.last().unwrap();
                writeln!(structs, "    struct {name} {{").unwrap();
                let fields = body.split(';').map(|f| f.split_whitespace().collect::<Vec<_>>().join(" "));
                fields.filter(|f| !f.is_empty()).for_each(|f| field(name, &f, &mut structs));
                structs += "    }\n";
            }
            head = tail;
        }
    }
    let [signed, bytes, unsigned] = lists;
    format!(
        "structs! {{\n    layouts;\n{structs}}}\n\nconstants! {{\n    i32 {{\n{signed}    }}\n    u8 {{\n{bytes}    }}\n    \
         u32 {{\n{unsigned}    }}\n}}\n\n{rest}"
    )
}
