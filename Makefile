# make demo    real models with soft shadows, in out/
# make test    every test, on each driver
# make bench   what accuracy costs in time, in out/accuracy_cost/, and what each technique does, in
#              out/bench/ and on the terminal (make bench QUICK=1 in under five minutes, the report
#              alone)
#
# make function F=shaders T=overlap DRIVER=SwiftShader   one test program, or those of its tests whose name holds
#              T, on one device; llvmpipe without DRIVER
#
# make sanitize   the library's unit tests under AddressSanitizer, which nightly Rust has
#
# ANTUMBRA_DRIVER=<part of a device name> picks the device for all of them.

.PHONY: demo test test_once test_on_llvmpipe test_on_swiftshader function bench sanitize clean

CARGO ?= cargo
SHELL := /bin/bash

# ---------------------------------------------------------------------------------------------

demo:
	@tests/drivers.sh demo
	@$(CARGO) build --release --example render
	@for model in bunny suzanne; do \
	    $(CARGO) run --quiet --release --example render -- scenes/$$model.glb --out out/$$model \
	        --repeat 9 || exit; \
	done
	@echo
	@echo "Look at out/bunny/shaded.png and out/suzanne/shaded.png; visibility.png beside them is"
	@echo "how much of the light each pixel sees, and report.json what each pass cost."

# Stopped and started again, the report goes on where it was.
bench:
	@tests/drivers.sh bench
ifndef QUICK
	@benches/fetch_dragon.sh || echo "without the dragon: it could not be fetched"
endif
	$(CARGO) bench --bench accuracy_cost -- $(if $(QUICK),--quick)
ifndef QUICK
	$(CARGO) bench --bench techniques
endif

# ---------------------------------------------------------------------------------------------

# Each tests/NAME/main.rs is a program, and so is each file of benches/*/tests. Those that tests/Cargo.toml lists run once,
# with a driver that is not there: a test among them that asks for a device fails. The others run once a driver.
once := $(shell sed -n 's/^once = \[\(.*\)\]$$/\1/p' tests/Cargo.toml | tr -d '",')
programs := $(patsubst tests/%/main.rs,%,$(wildcard tests/*/main.rs)) \
    $(basename $(notdir $(wildcard benches/tests/*.rs benches/*/tests/*.rs)))
# Where one driver is named, no other need be there.
test_once := $(CARGO) test --workspace --lib $(patsubst %,--test %,$(filter-out $(if $(ANTUMBRA_DRIVER),two_drivers),$(once)))
# The embed example's own tests are what the node says to an engine that gets something wrong, and the walk of a figure that
# an engine poses on the device.
test_on_device := $(CARGO) test --workspace $(patsubst %,--test %,$(filter-out $(once),$(programs))) --example embed
# Cargo must not look for the job server of the make above.
without_make := env -u MAKEFLAGS -u MFLAGS

# Beside the installed drivers; a device must still be chosen by its name.
SWIFTSHADER := VK_ADD_DRIVER_FILES=$(CURDIR)/.drivers/vk_swiftshader_icd.json
# A GPU shows as one of these. Without ANTUMBRA_DRIVER the best device is used, which is then the GPU.
GPU := $(wildcard /dev/dri/renderD* /dev/nvidia0 /dev/dxg)

# What each cargo prints is each program's own summary.
test: export ANTUMBRA_VALIDATE := 1
test: export ANTUMBRA_NO_SKIPS := 1
test:
	@tests/drivers.sh test
	$(CARGO) test --workspace --no-run
ifdef ANTUMBRA_DRIVER
	$(MAKE) --no-print-directory test_once
	$(SWIFTSHADER) $(test_on_device)
else
	$(MAKE) --no-print-directory -j2 --output-sync=target test_on_swiftshader test_once test_on_llvmpipe
ifneq ($(GPU),)
	$(test_on_device)
endif
endif

# Two at once: while SwiftShader compiles shaders, and where a test works on one thread, a core is idle.
# Each shows its output when it is done.
test_once test_on_llvmpipe test_on_swiftshader: export ANTUMBRA_VALIDATE := 1
test_once test_on_llvmpipe test_on_swiftshader: export ANTUMBRA_NO_SKIPS := 1

test_once:
	ANTUMBRA_DRIVER=none $(SWIFTSHADER) $(without_make) $(test_once)
	$(without_make) $(CARGO) test --workspace --doc

test_on_llvmpipe:
	ANTUMBRA_DRIVER=llvmpipe $(without_make) $(test_on_device)

test_on_swiftshader:
	ANTUMBRA_DRIVER=SwiftShader $(SWIFTSHADER) $(without_make) $(test_on_device)

# One test on one device, as a change is worked on. The whole workspace here too, or cargo builds the dependencies anew.
DRIVER ?= $(or $(ANTUMBRA_DRIVER),llvmpipe)
function: export ANTUMBRA_DRIVER := $(DRIVER)
function: export ANTUMBRA_VALIDATE := 1
function:
	$(if $(F),,$(error make function: name a test program, as in F=shaders; they are the folders tests/*/main.rs))
	@tests/drivers.sh function
	$(if $(findstring swiftshader,$(shell echo $(DRIVER) | tr A-Z a-z)),$(SWIFTSHADER)) \
	    $(CARGO) test --workspace --test $(F) $(T)

# Not a part of the tests: it builds everything anew, and takes longer than they do.
sanitize:
	@tests/sanitize.sh

clean:
	$(CARGO) clean
	rm -rf out .drivers
