# SPDX-License-Identifier: MIT
"""abi_types.py DUMP.xml: the structs of an ABI as libabigail's abidw sees it, a line each for the size and for every field:
STRUCT.FIELD BYTE TYPE, or STRUCT size BYTES. A variable is_NAME is a pointer to the function NAME: NAME function TYPE. Types are told down to
C's own, so that another name of the same type is none."""

import sys
import xml.etree.ElementTree as ElementTree


def main():
    root = ElementTree.parse(sys.argv[1]).getroot()
    nodes = {node.get("id"): node for node in root.iter() if node.get("id")}

    def told(type_id):
        node = nodes[type_id]
        tag, inner = node.tag, node.get("type-id")
        if tag == "typedef-decl":
            return told(inner)
        if tag == "pointer-type-def":
            return f"{told(inner)}*"
        if tag == "qualified-type-def":
            return f"{told(inner)} const" if node.get("const") else told(inner)
        if tag == "array-type-def":
            return told(inner) + "".join(f"[{part.get('length')}]" for part in node.iter("subrange"))
        if tag == "function-type":
            takes = ", ".join(told(part.get("type-id")) for part in node.iter("parameter"))
            return f"{told(node.find('return').get('type-id'))}({takes})"
        return node.get("name")

    lines = []
    for struct in root.iter("class-decl"):
        if struct.get("is-declaration-only"):
            continue
        lines.append(f"{struct.get('name')} size {int(struct.get('size-in-bits')) // 8}")
        for member in struct.iter("data-member"):
            field = member.find("var-decl")
            byte = int(member.get("layout-offset-in-bits")) // 8
            lines.append(f"{struct.get('name')}.{field.get('name')} {byte} {told(field.get('type-id'))}")
    for variable in root.findall("abi-instr/var-decl"):
        function = nodes[variable.get("type-id")].get("type-id")
        lines.append(f"{variable.get('name').removeprefix('is_')} function {told(function)}")
    print("\n".join(sorted(lines)))


main()
