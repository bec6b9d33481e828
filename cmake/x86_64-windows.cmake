# SPDX-License-Identifier: MIT
# A toolchain: Debian's mingw-w64 for 64-bit Windows. SV_WINDOWS_ROOT names a folder with include/CL and lib/libOpenCL.a, the import
# library of OpenCL.dll (scripts/windows.sh makes one).
#     cmake -S . -B build-windows -D CMAKE_TOOLCHAIN_FILE=cmake/x86_64-windows.cmake -D SV_WINDOWS_ROOT=FOLDER -D SV_PLUGIN_ONLY=ON
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++)
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES SV_WINDOWS_ROOT)
set(OpenCL_INCLUDE_DIR ${SV_WINDOWS_ROOT}/include)
set(OpenCL_LIBRARY ${SV_WINDOWS_ROOT}/lib/libOpenCL.a)
set(CMAKE_FIND_ROOT_PATH ${SV_WINDOWS_ROOT} /usr/x86_64-w64-mingw32)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)
set(ENV{PKG_CONFIG_LIBDIR} ${SV_WINDOWS_ROOT}/lib/pkgconfig:/usr/x86_64-w64-mingw32/lib/pkgconfig)
# No time of the build in what is linked: the same sources give the same bytes.
foreach(kind EXE SHARED MODULE)
  set(CMAKE_${kind}_LINKER_FLAGS_INIT -Wl,--no-insert-timestamp)
endforeach()
