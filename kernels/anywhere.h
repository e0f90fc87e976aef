// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Marks a function for every back end: the CUDA compiler makes it for the device, too.
#ifdef __CUDACC__
#define DISPARITYD_ANYWHERE __host__ __device__
#else
#define DISPARITYD_ANYWHERE
#endif
