// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <cuda_runtime.h>

namespace disparityd::cuda {

/// Operations in order. Destroyed when they are done or given up.
class Stream {
public:
    Stream();
    ~Stream();
    Stream(const Stream&) = delete;
    Stream& operator=(const Stream&) = delete;

    cudaStream_t get() const { return stream_; }
    /// Until all is done. An error of any operation shows here: `what` was being done.
    void wait(const std::string& what) const;

private:
    cudaStream_t stream_ = nullptr;
};

}  // namespace disparityd::cuda
