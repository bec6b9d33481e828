# SPDX-License-Identifier: MIT
# The short front door; CMake is the build's one truth. `make help` lists the targets.
JOBS ?= $(shell nproc 2>/dev/null || echo 2)
# ON: compiler warnings are errors. Off by default, so that a newer compiler's new warnings stop no user.
SV_WERROR ?= OFF
OUT ?= out
PLUGIN ?= build/smartvis.so
# Where `make install` puts everything; DESTDIR is put before it, as packagers do.
PREFIX ?= /usr/local
DESTDIR ?=
# `make test`: tests with such labels only, a regular expression (abi|check). All by default.
LABELS ?=
# `make test`: build and test one part alone: base, sdk, host_sim, python, lab, or house, which is what is asked of all. All by default.
PART ?=
# How long `make fuzz` gives each of its targets; one runs for each processor.
FUZZ_SECONDS ?= 600
FUZZ_SEED ?= 0
# `make dist`: with 1 it is made twice, in different folders, and has to be the same to the bit.
TWICE ?=
# Real scans for the demo, if there are any: `make example-scan` fetches one.
DATA ?= $(firstword $(wildcard ../shared/data $(OUT)/example))
# Folders of volumes of other programs with their truth, for `make sites` and `make surface-page`.
SITES ?= $(wildcard $(addsuffix /site_b,$(DATA)) $(addsuffix /site_c,$(DATA)))

SETUP := scripts/setup.sh
PACKAGES := scripts/packages.txt
LINT_PACKAGES := scripts/packages-lint.txt
PYTHON_PACKAGES := scripts/packages-python.txt
DEB_PACKAGES := scripts/packages-deb.txt
OCLGRIND_PACKAGES := scripts/packages-oclgrind.txt
FUZZ_PACKAGES := scripts/packages-fuzz.txt
AARCH64_PACKAGES := scripts/packages-aarch64.txt
WINDOWS_PACKAGES := scripts/packages-windows.txt
PEERS_PACKAGES := scripts/packages-peers.txt

# $(call step,<name>): one line for what comes behind it; its output is in out/log/<name>.log.
step = scripts/quietly.sh $(1) $(OUT)/log/$(1).log
# $(call build,<folder>,<further CMake arguments>,<targets>): without targets everything.
build = $(call step,configure) cmake -S . -B $(1) -G Ninja -DSV_WERROR=$(SV_WERROR) $(2) && \
	$(call step,build) cmake --build $(1) -j $(JOBS) $(if $(3),--target $(3))

# Other builds' tests need the same kernels as those of build: what PoCL compiled for one is there for all.
KERNELS := -DSV_TEST_CACHE=$(CURDIR)/build/pocl_cache

# What a frame computes, against the definitions: what other runtimes are held to.
RUNTIME_TESTS := $(shell sed -n 's/^tests //p' scripts/runtimes.txt)
empty :=
INTEL_TESTS := ^check/test_($(subst $(empty) $(empty),|,$(RUNTIME_TESTS)))$$
# Intel's kernels are kept for this run alone.
INTEL_CACHE := $(CURDIR)/build/intel/cache

.NOTPARALLEL:
.PHONY: all setup install dist deb try-deb wheel try-wheel aarch64 windows macos spdx demo console report test test-night soak test-intel test-runtimes test-slicer peers test-sanitize test-clang fuzz oclgrind lint lines format bench bench-against sites scans surface-page \
	validate clean help help-all example-scan

all: ## build/smartvis.so, build/host_sim and build/sv_validate (installs nothing)
	@$(SETUP) --check $(PACKAGES)
	@$(call build,build,,smartvis host_sim sv_validate)

setup: # install the Debian packages that are missing (needs root if any are)
	@$(SETUP) $(PACKAGES)

install: ## install to PREFIX (/usr/local), below DESTDIR if that is given
	@$(SETUP) --check $(PACKAGES)
	@$(call build,build,,installed)
	@DESTDIR='$(DESTDIR)' $(call step,install) cmake --install build --prefix '$(PREFIX)'

dist: # what a release of the commit consists of: sources, Debian packages, wheel, zip for Windows, SPDX, sums: out/dist
	@$(SETUP) $(PACKAGES) $(DEB_PACKAGES) $(PYTHON_PACKAGES) $(WINDOWS_PACKAGES)
	@scripts/release.sh $(OUT)/dist $(if $(TWICE),again)

deb: # Debian packages of the committed sources, looked over by lintian: out/deb
	@$(SETUP) $(PACKAGES) $(DEB_PACKAGES)
	@scripts/deb.sh $(OUT)/deb

try-deb: # install out/deb on this machine (needs root), then the template's three commands, from its README to a picture
	@scripts/try_deb.sh $(OUT)/deb

wheel: ## the Python package as a wheel for other machines, with host_sim and the OpenCL loader in it: out/wheel
	@$(SETUP) $(PACKAGES) $(PYTHON_PACKAGES)
	@$(call build,build,,host_sim smartvis)
	@bash tests/python/environment.sh . build python3
	@scripts/wheel.sh build $(OUT)/wheel

try-wheel: # install out/wheel where there is no OpenCL (needs PyPI), do what its message says, and clip a scene and a file
	@scripts/try_wheel.sh $(OUT)/wheel

aarch64: # plugin, validator and template for 64-bit ARM, and what the validator finds there under qemu: out/aarch64
	@$(SETUP) $(PACKAGES) $(AARCH64_PACKAGES)
	@$(call build,build,,smartvis)
	@SV_WERROR=$(SV_WERROR) scripts/aarch64.sh build $(OUT)/aarch64

windows: # SDK, template, host_sim and the Python wheel for 64-bit Windows, and what they do under wine against Linux: out/windows (needs PyPI)
	@$(SETUP) $(PACKAGES) $(PYTHON_PACKAGES) $(WINDOWS_PACKAGES)
	@$(call build,build,,smartvis smartvis_check sv_replay host_sim test_plugins small_host queue_host first_edge kernel_edge)
	@SV_WERROR=$(SV_WERROR) scripts/windows.sh build $(OUT)/windows

macos: # plugin and examples for macOS, compiled only: out/macos (needs PyPI)
	@$(SETUP) $(PACKAGES) $(PYTHON_PACKAGES)
	@$(call build,build,,smartvis kernel_edge)
	@scripts/macos.sh build $(OUT)/macos

spdx: # what the project is built with and runs with, with versions, as SPDX 2.3: out/smartvis.spdx
	@$(SETUP) --check $(PACKAGES)
	@$(call build,build)
	@scripts/spdx.sh build $(OUT)/smartvis.spdx

demo: setup ## set up, build, run the scan loop on demo volumes: pictures and a page in out/demo
	@start=$$(date +%s.%N); $(call build,build,,host_sim smartvis) && \
	build/host_sim demo --out $(OUT)/demo $(if $(DATA),--data $(DATA)) && \
	find $(OUT)/demo -name '*.png' -newermt "@$$start" -printf '%T@\n' | sort -n | \
	awk -v start=$$start -v now=$$(date +%s) 'NR == 1 { printf "demo: %.0f s to the first picture, %.0f s in all, the packages not counted\n", $$1 - start, now - start }'

example-scan: ## fetch the scan of the README's picture (MIT licence): out/example/real/fetus_12w.mha
	@scripts/example_scan.sh $(OUT)/example

console: setup ## set up, build, serve the live console for a browser of this machine; prints its address
	@$(call build,build,,host_sim smartvis)
	build/host_sim console $(DATA)

report: setup ## set up, build, measure quality and speed over all cases; the page is out/report/index.html
	@$(call build,build,,host_sim smartvis)
	build/host_sim report --out $(OUT)/report

test: ## set up, build, run all tests
	@$(SETUP) $(PACKAGES) $(PYTHON_PACKAGES)
	@$(call build,build,,$(PART:%=part_%))
	@scripts/run_tests.sh build $(JOBS) '$(LABELS)' '$(PART)'

test-night: # what takes long and proves little more than `make test` does
	@$(SETUP) $(PACKAGES) $(PYTHON_PACKAGES)
	@$(call build,build)
	@scripts/run_tests.sh build $(JOBS) night

soak: # SOAK (--frames 200000 --seconds 3600 --volumes 50000) of a scan loop, a console and serve: what they hold is flat; out/soak/soak.svg
	@$(SETUP) $(PACKAGES) $(PYTHON_PACKAGES)
	@$(call build,build,,host_sim smartvis soak_frames)
	@$(call step,environment) bash tests/python/environment.sh . build python3
	@POCL_CACHE_DIR=$(CURDIR)/build/pocl_cache SMARTVIS_HOST_SIM=$(CURDIR)/build/host_sim \
	  build/python/venv/bin/python -B -P tests/soak/soak.py build $(OUT)/soak $(SOAK)

test-intel: # the frames of `make test` on Intel's OpenCL for CPUs, from PyPI: an hour, most of it compiling
	@$(SETUP) $(PACKAGES) $(PYTHON_PACKAGES)
	@$(call build,build)
	@mkdir -p build/intel && scripts/python_env.sh build/intel python/requirements-intel.txt
	@readlink -f build/intel/lib/libintelocl.so > build/intel/intel.icd
	@rm -rf $(INTEL_CACHE)
	@XDG_CACHE_HOME=$(INTEL_CACHE) POCL_CACHE_DIR=$(CURDIR)/build/pocl_cache bash tests/sdk/check/second_runtime.sh build build/intel/intel.icd
	@XDG_CACHE_HOME=$(INTEL_CACHE) OCL_ICD_VENDORS=$(CURDIR)/build/intel/intel.icd ctest --test-dir build --output-on-failure -R '$(INTEL_TESTS)'
	@XDG_CACHE_HOME=$(INTEL_CACHE) OCL_ICD_VENDORS=$(CURDIR)/build/intel/intel.icd build/sv_validate --level 1 --timeout 300 build/smartvis.so

test-runtimes: # the same on PoCL 6 and 7 and Mesa's rusticl, from newer Debian suites: out/runtimes (needs namespaces)
	@$(SETUP) $(PACKAGES)
	@$(call build,build,,smartvis sv_validate every_method $(RUNTIME_TESTS:%=test_%))
	@scripts/runtimes.sh build $(OUT)/runtimes

test-slicer: # 3D Slicer's own parser, logic and nodes with the command-line module (needs PyPI)
	@$(SETUP) $(PACKAGES) $(PYTHON_PACKAGES)
	@$(call build,build,,host_sim smartvis)
	@bash tests/python/environment.sh . build python3
	@scripts/slicer.sh build

peers: # what 3D Slicer, ITK, MONAI and others read of ours, and we of theirs, against docs/peers.md (WRITE=1: into it): out/peers (PyPI, 10 GB)
	@$(SETUP) $(PACKAGES) $(PYTHON_PACKAGES) $(PEERS_PACKAGES)
	@$(call build,build,,host_sim smartvis)
	@$(call step,python) bash tests/python/environment.sh . build python3
	@scripts/peers.sh build $(OUT)/peers $(if $(WRITE),--write)

test-sanitize: setup # the tests under AddressSanitizer, LeakSanitizer and UndefinedBehaviorSanitizer
	@# Without SV_WERROR: gcc warns wrongly in instrumented code.
	@$(call build,build-sanitize,-DSV_SANITIZE=ON -DSV_WERROR=OFF $(KERNELS))
	@scripts/run_tests.sh build-sanitize $(JOBS)

test-clang: # the tests, built with clang
	@$(SETUP) $(PACKAGES) $(LINT_PACKAGES) $(PYTHON_PACKAGES)
	@$(call build,build-clang,-DCMAKE_C_COMPILER=clang $(KERNELS))
	@scripts/run_tests.sh build-clang $(JOBS)

fuzz: # FUZZ_SECONDS (600) of libFuzzer for every target in tests/fuzz, from FUZZ_SEED (0: a new one); what it finds stays in out/fuzz
	@$(SETUP) $(PACKAGES) $(FUZZ_PACKAGES)
	@$(call build,build-fuzz,-DCMAKE_C_COMPILER=clang -DSV_FUZZ=ON -DSV_BENCH=OFF,fuzz_targets)
	@scripts/fuzz.sh build-fuzz $(FUZZ_SECONDS) $(JOBS) $(OUT)/fuzz $(FUZZ_SEED)

oclgrind: # every method on a small frame in a simulated device that sees wrong accesses and data races
	@$(SETUP) $(PACKAGES) $(OCLGRIND_PACKAGES)
	@$(call build,build,,every_method smartvis)
	@scripts/oclgrind.sh build $(JOBS) $(OUT)/oclgrind

lint: # format, house rules, links, floors, clang warnings, clang-tidy, kernels, ruff and mypy; ANALYZER=deep before a release
	@$(SETUP) $(PACKAGES) $(LINT_PACKAGES)
	@$(call build,build-clang,-DCMAKE_C_COMPILER=clang -DSV_WERROR=ON,embedded)
	@scripts/lint.sh build-clang $(JOBS)

lines: # files, lines and includes of the parts of the house, words of the pages; COMMIT=...: of that commit
	@scripts/lines.sh $(COMMIT)

format: # apply .clang-format to all C and OpenCL C, ruff's format to Python
	@$(SETUP) $(LINT_PACKAGES)
	@scripts/list_sources.sh c h hpp cpp cl clh | xargs clang-format -i
	@mkdir -p build-clang && scripts/python_env.sh build-clang/lint python/requirements-lint.txt
	@cd python && ../build-clang/lint/bin/ruff format --quiet --no-cache --config pyproject.toml . ../examples/python ../lab ../tests/lab

bench: setup # times as ratios to plain C; speed against error of every method; growth with the volume: out/bench (some twelve minutes)
	@$(call build,build,,sv_bench test_lit_shapes smartvis host_sim sv_definitions)
	build/sv_bench
	build/tests/test_lit_shapes 512
	@mkdir -p $(OUT)/bench
	@scripts/python_env.sh build/python/bench python/requirements-test.txt
	PYTHONPATH=python SMARTVIS_PLUGIN=build/smartvis.so SMARTVIS_HOST_SIM=build/host_sim \
	  build/python/bench/bin/python python/bench/surfaces.py --csv $(OUT)/bench/surfaces.csv --svg $(OUT)/bench/surfaces.svg
	PYTHONPATH=python SMARTVIS_PLUGIN=build/smartvis.so SMARTVIS_HOST_SIM=build/host_sim \
	  build/python/bench/bin/python python/bench/growth.py --csv $(OUT)/bench/growth.csv --svg $(OUT)/bench/growth.svg

bench-against: # this checkout beside COMMIT=..., both built in out/bench_against and run in turn: a table with ratios and goals; QUICK=1: a short one
	@$(SETUP) $(PACKAGES)
	@python3 scripts/bench_against.py $(or $(COMMIT),$(error COMMIT=... names what this checkout is compared with)) $(if $(QUICK),--quick) --out $(OUT)/bench_against

# Hard scenes, scenes that no constant was chosen on, and some that were looked at; the site, and volumes that nothing hides.
HARD_NAMES := $(foreach n,01 02 03 04 05 06 07 08 09 10 11 12 13 14 15 16,H$(n))
HARD := $(HARD_NAMES:%=--scene %)
UNSEEN := --scenes 501,0 --scenes 502,41 --scenes 503,42
FOREIGN = $(foreach site,$(SITES),--site $(site)) $(if $(DATA),$(foreach volume,$(wildcard $(DATA)/*.mha),--volume $(volume)))

# Other near fields, slices:gain:black: a dead zone, gel, skin lines, poor coupling.
NEAR_FIELDS := 2:0.25:0 4:0:1 6:0:1 3:1:60 4:1:100 8:0.4:0
part = $(word $(1),$(subst :, ,$(2)))
near_field = --set near_slices=$(call part,1,$(1)) --set near_gain=$(call part,2,$(1)) --set near_black=$(call part,3,$(1))

sites: setup # methods on scenes and on SITES: table, harm, near fields, flicker
	@$(call build,build,,sv_definitions smartvis host_sim smartvis_host)
	scripts/surfaces.sh table $(UNSEEN) $(FOREIGN)
	scripts/surfaces.sh table $(HARD)
	scripts/surfaces.sh harm --scenes 201,0 $(FOREIGN)
	$(foreach field,$(NEAR_FIELDS),scripts/surfaces.sh wall --scenes 201,0 $(foreach site,$(SITES),--site $(site)) $(call near_field,$(field)) &&) true
	scripts/surfaces.sh flicker

# Every scene in a box, and as a probe's file.
SCENES := E01 E02 E03 E04 M01 M02 M03 D01 D02 $(HARD_NAMES)
vol_case = --case $(OUT)/scans/$(1)_full.vol,$(OUT)/scans/$(1)_truth.vol,$(OUT)/scans/$(1)_label.mha

scans: setup # verdict, error, cut, left of scenes, SITES and the scans in DATA, with beams told, the pose alone, nothing: ten minutes
	@$(call build,build,,smartvis host_sim smartvis_host)
	@$(call step,scenes) for set in all hard; do build/host_sim scenes --$$set --size 128 --export --format vol --out $(OUT)/scans || exit 1; done
	@scripts/surfaces.sh scans --method method=wall --method 'method=wall unsure=clip' $(foreach scene,$(SCENES),--scene $(scene) $(call vol_case,$(scene))) \
	  $(foreach site,$(SITES),--site $(site))
	@scripts/surfaces.sh scans $(foreach scan,$(filter-out %_label.mha,$(wildcard $(DATA)/real/*.mha $(DATA)/fetal_head_*.mha)),--volume $(scan))

# A case of a site: its three files, and what was scanned of every ray, of the case or of all.
stem = $(patsubst %_full.mha,%,$(1))
comma := ,
scanned = $(comma)$(firstword $(wildcard $(call stem,$(1))_$(2).mha $(dir $(1))scan_$(2).mha))
site_case = --case $(1),$(call stem,$(1))_truth.mha,$(call stem,$(1))_label.mha$(call scanned,$(1),first)$(call scanned,$(1),end)
draw = build/host_sim report --lowres 128 --coarse --frames 0 --out $(OUT)/sites/$(1)

surface-page: setup # method wall on scenes and on SITES in pictures: out/sites/scenes/index.html, out/sites/SITE/index.html
	@$(call build,build,,host_sim smartvis)
	$(call draw,scenes) --size 128
	$(foreach site,$(SITES),$(call draw,$(notdir $(site))) $(foreach full,$(wildcard $(site)/*_full.mha),$(call site_case,$(full))) &&) true

validate: setup ## tries PLUGIN (build/smartvis.so) with every check of build/sv_validate
	@$(call build,build,,sv_validate smartvis)
	build/sv_validate $(PLUGIN)

clean: ## remove everything that was built
	rm -rf build build-sanitize build-clang build-fuzz out

# $(call targets,<marks>): those with so many marks before their description.
targets = sed -n 's/^\([a-z0-9-]*\):[^\#]*\#\{$(1)\} \(.*\)/  make \1 \t\2/p' Makefile | expand -t 24

help: # this list
	@$(call targets,2)
	@echo "make help-all lists what developers of SmartVis need, too."

help-all: # this list, whole
	@$(call targets,2)
	@echo "For developers of SmartVis:"
	@$(call targets,1)
