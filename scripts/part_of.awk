# SPDX-License-Identifier: MIT
# The part of the house that a file belongs to. part_plugin has no tests of its own: they are the SDK's.
function part_of(file) {
    if (file ~ /^(include|src|cl)\//) return "plugin"
    if (file ~ /^(base|tests\/base)\//) return "base"
    if (file ~ /^(sdk|examples|bindings|abi|tests\/sdk|tests\/programs)\//) return "sdk"
    if (file ~ /^(host_sim|data|tests\/host_sim)\//) return "host_sim"
    if (file ~ /^(python|tests\/python)\//) return "python"
    if (file ~ /^(lab|tests\/lab)\//) return "lab"
    if (file ~ /^(docs\/.*|[^\/]*\.md)$/) return "docs"
    return "rest"
}

# The parts whose tests a change of a part concerns: its own, and of what is built on it or loads it. test_parts.sh holds that to what
# CMake knows. Tests of base load the plugin and are linked with the SDK's support; host_sim has the lab's commands; pages are read by
# tests of the SDK.
function concerned(part) {
    if (part == "base" || part == "plugin") return "base sdk host_sim python lab"
    if (part == "sdk") return "base sdk host_sim lab"
    if (part == "host_sim" || part == "lab") return "host_sim python lab"
    if (part == "python") return "python lab"
    if (part == "docs") return "sdk"
    return part
}
