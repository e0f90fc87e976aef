// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include <cuda_runtime.h>

namespace disparityd::cuda {

/// Throws std::runtime_error "CUDA, WHAT: the error" unless the call succeeded.
void check(cudaError_t result, const std::string& what);

/// Why this machine's GPU cannot be used (no driver, driver too old, no device, no code for it); empty when it can.
std::string device_problem();

/// Whether the device shares the host's memory, as Jetsons do: then what both see is mapped, not copied.
bool device_is_integrated();

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

/// Memory that host and device both see: pinned on the host, with a twin on the device or, on an integrated one,
/// mapped: then nothing is copied.
class ExchangeMemory {
public:
    ExchangeMemory() = default;
    ExchangeMemory(std::size_t bytes, const std::string& what);
    ~ExchangeMemory();
    ExchangeMemory(ExchangeMemory&& other) noexcept;
    ExchangeMemory& operator=(ExchangeMemory&& other) noexcept;

    template <typename T>
    T* host() const {
        return static_cast<T*>(host_);
    }
    template <typename T>
    T* device() const {
        return static_cast<T*>(mapped_ != nullptr ? mapped_ : twin_.as<void>());
    }
    std::size_t size() const { return size_; }

    void to_device(const Stream& stream) const;
    void to_host(const Stream& stream) const;

private:
    std::size_t size_ = 0;
    void* host_ = nullptr;
    void* mapped_ = nullptr;
    DeviceMemory twin_;
};

/// Times between marks on a stream.
class StreamClock {
public:
    explicit StreamClock(std::size_t marks);
    ~StreamClock();
    StreamClock(const StreamClock&) = delete;
    StreamClock& operator=(const StreamClock&) = delete;

    /// On a stream whose operations a Graph takes, the mark becomes one of them.
    void mark(std::size_t i, const Stream& stream) const;
    /// From mark i to the next one, after the stream was waited for.
    std::chrono::nanoseconds after(std::size_t i) const;

private:
    StreamClock() = default;

    std::vector<cudaEvent_t> events_;
};

}  // namespace disparityd::cuda
