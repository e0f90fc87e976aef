// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <cuda_runtime.h>

namespace disparityd::cuda {

/// Throws std::runtime_error "CUDA, WHAT: the error" unless the call succeeded.
void check(cudaError_t result, const std::string& what);

/// Why this machine's GPU cannot be used (no driver, driver too old, no device, no code for it); empty when it can.
std::string device_problem();

/// Whether the device shares the host's memory, as Jetsons do: then what both see is mapped, not copied.
bool device_is_integrated();

/// Multiprocessors of the device.
int multiprocessors();

}  // namespace disparityd::cuda
