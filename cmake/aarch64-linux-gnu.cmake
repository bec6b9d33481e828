# SPDX-License-Identifier: MIT
# A toolchain: Debian's cross compiler for 64-bit ARM. SV_AARCH64_ROOT names a folder that holds the libraries of that
# architecture, as in / of such a machine: libOpenCL for the plugin, libjansson for the validator (scripts/aarch64.sh makes one).
#     cmake -S . -B build-aarch64 -D CMAKE_TOOLCHAIN_FILE=cmake/aarch64-linux-gnu.cmake -D SV_AARCH64_ROOT=FOLDER -D SV_PLUGIN_ONLY=ON
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES SV_AARCH64_ROOT)
# Libraries come from that folder, programs from this machine; packages such as SmartVisPlugin from where they are named.
set(CMAKE_FIND_ROOT_PATH ${SV_AARCH64_ROOT} /usr/aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${SV_AARCH64_ROOT})
set(ENV{PKG_CONFIG_LIBDIR} ${SV_AARCH64_ROOT}/usr/lib/aarch64-linux-gnu/pkgconfig)
