# SPDX-License-Identifier: MIT
# The part of the house that a file belongs to.
function part_of(file) {
    if (file ~ /^(include|src|cl|examples|bindings|abi|tools\/sdk|tests\/sdk|tests\/programs)\//) return "sdk"
    if (file ~ /^(host_sim|data|python|tools\/machine|tests\/machine)\//) return "machine"
    if (file ~ /^(lab|tests\/lab)\//) return "lab"
    return "rest"
}
