# make demo    real models with soft shadows, in out/
# make test    every test, on each driver
# make bench   what accuracy costs in time, in out/accuracy_cost/, and what each technique does, in
#              out/bench/ and on the terminal (make bench QUICK=1 in under five minutes, the report
#              alone)
#
# make function F=shader_functions T=overlap DRIVER=SwiftShader   one test program, or those of its tests whose
#              name holds T, on one device; llvmpipe without DRIVER
#
# make sanitize   the library's unit tests under AddressSanitizer, which nightly Rust has
#
# ANTUMBRA_DRIVER=<part of a device name> picks the device for all of them.

.PHONY: demo test test_on_llvmpipe test_on_swiftshader function bench sanitize clean

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

# Tests that use no device; they run once. Every other file in tests/ runs once a driver.
NO_DEVICE := docs freshness house line_truth naga_translation one_build planning reflection refusals row_limits rows untrusted
DEVICE := $(filter-out $(NO_DEVICE),$(basename $(notdir $(wildcard tests/*.rs))))
test_once := $(CARGO) test --workspace --lib $(NO_DEVICE:%=--test %)
# The embed example's own tests are what the node says to an engine that gets something wrong;
# wrong_light and hard_cases are the benchmark's: that its report sees what is wrong, and its table of hard cases.
test_on_device := $(CARGO) test --workspace $(DEVICE:%=--test %) --test wrong_light --test hard_cases --example embed
# Cargo must not look for the job server of the make above.
test_on_driver := env -u MAKEFLAGS $(test_on_device)

# Beside the installed drivers; a device must still be chosen by its name.
SWIFTSHADER := VK_ADD_DRIVER_FILES=$(CURDIR)/.drivers/vk_swiftshader_icd.json
# A GPU shows as one of these. Without ANTUMBRA_DRIVER the best device is used, which is then the GPU.
GPU := $(wildcard /dev/dri/renderD* /dev/nvidia0 /dev/dxg)

test: export ANTUMBRA_VALIDATE := 1
test:
	@tests/drivers.sh test
	$(test_once)
	$(CARGO) test --workspace --doc
ifdef ANTUMBRA_DRIVER
	$(SWIFTSHADER) $(test_on_device)
else
	$(test_on_device) --no-run
	$(MAKE) --no-print-directory -j2 --output-sync=target test_on_llvmpipe test_on_swiftshader
ifneq ($(GPU),)
	$(test_on_device)
endif
endif

# Both at once: while SwiftShader compiles shaders, and where a test works on one thread, a core is idle.
# Each shows its output when it is done.
test_on_llvmpipe test_on_swiftshader: export ANTUMBRA_VALIDATE := 1

test_on_llvmpipe:
	ANTUMBRA_DRIVER=llvmpipe $(test_on_driver)

test_on_swiftshader:
	ANTUMBRA_DRIVER=SwiftShader $(SWIFTSHADER) $(test_on_driver)

# One test on one device, as a change is worked on. The whole workspace here too, or cargo builds the dependencies anew.
DRIVER ?= $(or $(ANTUMBRA_DRIVER),llvmpipe)
function: export ANTUMBRA_DRIVER := $(DRIVER)
function: export ANTUMBRA_VALIDATE := 1
function:
	$(if $(F),,$(error make function: name a test program, as in F=shader_functions; tests/Cargo.toml lists them))
	@tests/drivers.sh test
	$(if $(findstring swiftshader,$(shell echo $(DRIVER) | tr A-Z a-z)),$(SWIFTSHADER)) \
	    $(CARGO) test --workspace --test $(F) $(T)

# Not a part of the tests: it builds everything anew, and takes longer than they do.
sanitize:
	@tests/sanitize.sh

clean:
	$(CARGO) clean
	rm -rf out .drivers
