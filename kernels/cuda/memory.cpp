// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/memory.h"

#include <stdexcept>
#include <utility>

#include "kernels/cuda/device.h"

namespace disparityd::cuda {

namespace {

std::string megabytes(std::size_t bytes) {
    return std::to_string((bytes + 999999) / 1000000) + " MB";
}

// Most likely too little memory, which can be helped by whoever configured this.
void check_memory(cudaError_t result, std::size_t bytes, const std::string& what, const char* where) {
    if (result == cudaErrorMemoryAllocation) {
        static_cast<void>(cudaGetLastError());  // it has been told
        std::size_t free = 0;
        std::size_t total = 0;
        static_cast<void>(cudaMemGetInfo(&free, &total));
        throw std::runtime_error("CUDA: no memory for " + what + ": " + megabytes(bytes) + " wanted " + where + ", " +
                                 megabytes(free) + " of " + megabytes(total) +
                                 " free on the device; choose a smaller image, fewer disparities or paths, or the back "
                                 "end cpu");
    }
    check(result, "memory for " + what);
}

}  // namespace

DeviceMemory::DeviceMemory(std::size_t bytes, const std::string& what) {
    check_memory(cudaMalloc(&data_, bytes), bytes, what, "on the device");
}

DeviceMemory::~DeviceMemory() {
    static_cast<void>(cudaFree(data_));
}

DeviceMemory::DeviceMemory(DeviceMemory&& other) noexcept : data_(std::exchange(other.data_, nullptr)) {}

DeviceMemory& DeviceMemory::operator=(DeviceMemory&& other) noexcept {
    std::swap(data_, other.data_);
    return *this;
}

// From the other constructor on it is destroyed, so that nothing is lost when a later step fails.
PinnedBuffer::PinnedBuffer(std::size_t bytes, const std::string& what) : PinnedBuffer() {
    size_ = bytes;
    check_memory(cudaHostAlloc(&host_, bytes, cudaHostAllocMapped), bytes, what, "pinned on the host");
    if (device_is_integrated()) {
        check(cudaHostGetDevicePointer(&mapped_, host_, 0), "mapping " + what);
    } else {
        device_copy_ = DeviceMemory(bytes, what);
    }
}

PinnedBuffer::~PinnedBuffer() {
    static_cast<void>(cudaFreeHost(host_));
}

PinnedBuffer::PinnedBuffer(PinnedBuffer&& other) noexcept {
    *this = std::move(other);
}

PinnedBuffer& PinnedBuffer::operator=(PinnedBuffer&& other) noexcept {
    std::swap(size_, other.size_);
    std::swap(host_, other.host_);
    std::swap(mapped_, other.mapped_);
    std::swap(device_copy_, other.device_copy_);
    return *this;
}

void PinnedBuffer::to_device(const Stream& stream) const {
    if (mapped_ == nullptr) {
        check(cudaMemcpyAsync(device_copy_.as<void>(), host_, size_, cudaMemcpyHostToDevice, stream.get()),
              "copying to the device");
    }
}

void PinnedBuffer::to_host(const Stream& stream) const {
    if (mapped_ == nullptr) {
        check(cudaMemcpyAsync(host_, device_copy_.as<void>(), size_, cudaMemcpyDeviceToHost, stream.get()),
              "copying from the device");
    }
}

}  // namespace disparityd::cuda
