// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/stream.h"

#include "kernels/cuda/device.h"

namespace disparityd::cuda {

Stream::Stream() {
    check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "creating a stream");
}

Stream::~Stream() {
    static_cast<void>(cudaStreamSynchronize(stream_));
    static_cast<void>(cudaStreamDestroy(stream_));
}

void Stream::wait(const std::string& what) const {
    check(cudaStreamSynchronize(stream_), what);
}

}  // namespace disparityd::cuda
