// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "kernels/cuda/stream.h"

namespace disparityd::cuda {

/// Device memory for `what`, owned. Throws std::runtime_error that says how much was wanted and how much is free.
class DeviceMemory {
public:
    DeviceMemory() = default;
    DeviceMemory(std::size_t bytes, const std::string& what);
    ~DeviceMemory();
    DeviceMemory(DeviceMemory&& other) noexcept;
    DeviceMemory& operator=(DeviceMemory&& other) noexcept;

    template <typename T>
    T* as() const {
        return static_cast<T*>(data_);
    }

private:
    void* data_ = nullptr;
};

/// Memory that host and device both use: pinned on the host, with a copy on the device. On an integrated device it is
/// mapped instead, and nothing is copied.
class PinnedBuffer {
public:
    PinnedBuffer() = default;
    PinnedBuffer(std::size_t bytes, const std::string& what);
    ~PinnedBuffer();
    PinnedBuffer(PinnedBuffer&& other) noexcept;
    PinnedBuffer& operator=(PinnedBuffer&& other) noexcept;

    template <typename T>
    T* host() const {
        return static_cast<T*>(host_);
    }
    template <typename T>
    T* device() const {
        return static_cast<T*>(mapped_ != nullptr ? mapped_ : device_copy_.as<void>());
    }
    std::size_t size() const { return size_; }

    void to_device(const Stream& stream) const;
    void to_host(const Stream& stream) const;

private:
    std::size_t size_ = 0;
    void* host_ = nullptr;
    void* mapped_ = nullptr;
    DeviceMemory device_copy_;
};

}  // namespace disparityd::cuda
