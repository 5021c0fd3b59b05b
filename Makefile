# Each target does all that it needs by itself: packages (apt.txt), configuration, build. All are quick when nothing changed.
SHELL := bash
.SHELLFLAGS := -eu -o pipefail -c
.DELETE_ON_ERROR:
.DEFAULT_GOAL := help

JOBS ?= $(shell nproc)
# Tests at a time: one of them waits for a browser.
TEST_JOBS ?= $(shell expr $(JOBS) + 1)
FUZZ_SECONDS ?= 60
WERROR ?= OFF
DEMO_OUT ?= out/demo
DEMO ?= build/release/bin/isobath run --out $(DEMO_OUT)

.PHONY: help setup demo demo-aboard test bench lint files tidy fuzz format clean test-asan test-tsan
help: ## This list
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile | expand -t 14

setup:
	@scripts/setup

# Configured again only when the presets or WERROR change; ninja itself sees changed CMake files.
build/%/.configured-$(WERROR): CMakePresets.json | setup build
	@rm -f build/$*/.configured-*
	cmake --preset $* $(if $(filter ON,$(WERROR)),-DISOBATH_WERROR=ON) > build/$*.log || { tail -n 30 build/$*.log; exit 1; }
	@mv build/$*.log build/$*/configure.log && touch $@
.PRECIOUS: build/%/.configured-$(WERROR)
build:
	@mkdir -p build
# clang-tidy stands where the compiler stands, so that ninja knows what to look at again; new rules look at everything. The rules are
# for the library: tests say things twice where it reads better.
build/lint/.configured-$(WERROR): build/lint/.rules
build/lint/.rules: .clang-tidy $(wildcard scripts/lint/*) | build
	@rm -rf build/lint && mkdir -p build/lint && touch $@
# Without the headers of clang-tidy's own libraries it does without, and takes four times as long.
build/lint/own_code.so: build/lint/.rules
	@headers=$$(dirname "$$(readlink -f "$$(command -v clang-tidy)")")/../include; \
	if [[ -f $$headers/clang/ASTMatchers/ASTMatchFinder.h ]]; then \
	  $(CXX) -std=c++17 -O1 -fno-rtti -fPIC -shared -I"$$headers" -o $@ scripts/lint/own_code.cpp; fi

build-%: build/%/.configured-$(WERROR)
	@cmake --build build/$* --parallel $(JOBS)

run-tests-%: build-%
	ctest --test-dir build/$* --parallel $(TEST_JOBS) --output-on-failure --no-tests=error

demo: build/release/.configured-$(WERROR) ## Run the program on what it brings along; says where the report is
	@cmake --build build/release --parallel $(JOBS) --target isobath_app
	$(DEMO)
	@echo "Report: $(DEMO_OUT)/report.html"

# The pace of the demo; 1 is that of the clock.
ABOARD_SPEED ?= 1
# Its sonar: ping360 over UDP, or oculus over TCP.
SONAR ?= ping360
demo-aboard: build/release/.configured-$(WERROR) ## A vehicle of stand-ins, joined over sockets and steered past the buoys
	@cmake --build build/release --parallel $(JOBS) --target isobath_app
	@scripts/demo-aboard build/release/bin/isobath out/demo-aboard $(ABOARD_SPEED) $(SONAR)

test: run-tests-release ## Build and run all the tests; `make test-ROOM`: those of one room
test-%: build/release/.configured-$(WERROR)
	@cmake --build build/release --parallel $(JOBS) --target $*_tests
	ctest --test-dir build/release --parallel $(TEST_JOBS) --output-on-failure --no-tests=error -R '^$*\.'
test-asan: export LSAN_OPTIONS := suppressions=$(CURDIR)/tests/leak_sanitizer.supp:print_suppressions=0
test-asan: run-tests-asan ## The same built by clang, with the address and undefined-behaviour sanitizers
test-tsan: build/tsan/.configured-$(WERROR) ## Those that start threads, with the thread sanitizer
	@cmake --build build/tsan --parallel $(JOBS) --target isobath_threads_tests
	TSAN_OPTIONS=suppressions=$(CURDIR)/tests/thread_sanitizer.supp ctest --test-dir build/tsan --parallel $(JOBS) --output-on-failure --no-tests=error -L threads

bench: build-bench ## Run the benchmarks
	@for program in build/bench/bench/*_bench; do echo "== $$program"; "$$program"; done
	@chromium=$$(command -v chromium chromium-browser google-chrome | head -n 1); \
	if [[ -n "$$chromium" ]] && command -v node > /dev/null; then echo "== bench/click_to_picture.mjs"; \
	  ISOBATH_PROGRAM=build/bench/bin/isobath ISOBATH_CHROMIUM=$$chromium node bench/click_to_picture.mjs; \
	else echo "bench/click_to_picture.mjs: needs node and Chromium"; fi

lint: setup ## Formatting, repository hygiene, clang-tidy on each source and header by itself; warnings are errors
	@status=0; for check in files tidy; do $(MAKE) --no-print-directory $$check || status=1; done; exit $$status
files:
	@scripts/check-files
tidy: build/lint/.configured-$(WERROR) build/lint/own_code.so ## clang-tidy on each source and header by itself; ROOM=map: those of a room
	@units=$$(ninja -C build/lint -t targets all | sed -n 's/: CXX_COMPILER__.*//p' | grep -E '(^|/)$(if $(ROOM),isobath/$(ROOM)/,(isobath|bench)/).*\.cpp\.o$$'); \
	ISOBATH_TIDY_PRELOAD=$$(realpath -q build/lint/own_code.so || true) ninja -C build/lint -k 0 -j $(JOBS) $$units

fuzz: build-fuzz ## Run every fuzz target FUZZ_SECONDS long (60), from its corpus
	@for program in build/fuzz/tests/fuzz/*_fuzz; do \
	  name=$$(basename $$program _fuzz); mkdir -p build/fuzz/found/$$name; \
	  echo "== $$name, $(FUZZ_SECONDS) s"; \
	  "$$program" -max_total_time=$(FUZZ_SECONDS) -timeout=10 -rss_limit_mb=2048 -print_final_stats=1 -verbosity=0 \
	    -artifact_prefix=build/fuzz/found/$$name. build/fuzz/found/$$name \
	    $$(ls -d tests/fuzz/corpus/$$name 2>/dev/null || true); \
	done

format: setup ## Format all C++ in place
	@find $(wildcard isobath tests bench examples) -name '*.[ch]pp' -print0 | xargs -0 clang-format -i

clean: ## Remove what was built
	rm -rf build out
