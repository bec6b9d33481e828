#!/bin/bash
# SPDX-License-Identifier: MIT
# list_methods.sh: the methods of src/method_list.h, a line each.
set -eu
sed -n 's/^ *X([A-Z]*, [0-9]*, \([a-z]*\)).*/\1/p' "$(dirname "$0")/../src/method_list.h" | grep .
