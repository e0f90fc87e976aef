// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Takes the place of the toolkit's header where kernels/cuda is compiled for the processor.
#include "tests/emulation/builtins.h"
#include "tests/emulation/intrinsics.h"
#include "tests/emulation/runtime_api.h"
#include "tests/emulation/textures.h"
