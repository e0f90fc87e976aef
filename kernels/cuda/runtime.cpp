// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/runtime.h"

#include <stdexcept>
#include <utility>

#include "kernels/cuda/steps.h"

namespace disparityd::cuda {

namespace {

std::string megabytes(std::size_t bytes) {
    return std::to_string((bytes + 999999) / 1000000) + " MB";
}

std::string version(int number) {
    return std::to_string(number / 1000) + "." + std::to_string(number % 1000 / 10);
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

void check(cudaError_t result, const std::string& what) {
    if (result != cudaSuccess) {
        throw std::runtime_error("CUDA, " + what + ": " + cudaGetErrorString(result));
    }
}

void check_launch(const char* kernel) {
    check(cudaGetLastError(), std::string("start of ") + kernel);
}

std::string device_problem() {
    int driver = 0;
    int runtime = 0;
    if (cudaDriverGetVersion(&driver) != cudaSuccess || driver == 0) {
        return "no NVIDIA driver is installed";
    }
    static_cast<void>(cudaRuntimeGetVersion(&runtime));
    int devices = 0;
    const cudaError_t counted = cudaGetDeviceCount(&devices);
    static_cast<void>(cudaGetLastError());
    if (counted == cudaErrorInsufficientDriver) {
        return "the NVIDIA driver is too old: it is for CUDA " + version(driver) + ", this program for " +
               version(runtime) + "; update the driver";
    }
    if (counted == cudaErrorNoDevice || (counted == cudaSuccess && devices == 0)) {
        return "the NVIDIA driver finds no GPU";
    }
    if (counted != cudaSuccess) {
        return std::string("the NVIDIA driver reports: ") + cudaGetErrorString(counted);
    }
    const cudaError_t code = code_for_device();
    if (code == cudaErrorInvalidDeviceFunction || code == cudaErrorNoKernelImageForDevice) {
        int major = 0;
        int minor = 0;
        static_cast<void>(cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, 0));
        static_cast<void>(cudaDeviceGetAttribute(&minor, cudaDevAttrComputeCapabilityMinor, 0));
        return "this program holds no code for compute capability " + std::to_string(major) + "." +
               std::to_string(minor) + "; build it with -DCMAKE_CUDA_ARCHITECTURES=" + std::to_string(major) +
               std::to_string(minor);
    }
    if (code != cudaSuccess) {
        return std::string("the NVIDIA driver reports: ") + cudaGetErrorString(code);
    }
    return {};
}

bool device_is_integrated() {
    int integrated = 0;
    int mappable = 0;
    check(cudaDeviceGetAttribute(&integrated, cudaDevAttrIntegrated, 0), "properties of the device");
    check(cudaDeviceGetAttribute(&mappable, cudaDevAttrCanMapHostMemory, 0), "properties of the device");
    return integrated != 0 && mappable != 0;
}

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

// From the other constructor on it is destroyed, so that nothing is lost when a later step fails.
ExchangeMemory::ExchangeMemory(std::size_t bytes, const std::string& what) : ExchangeMemory() {
    size_ = bytes;
    check_memory(cudaHostAlloc(&host_, bytes, cudaHostAllocMapped), bytes, what, "pinned on the host");
    if (device_is_integrated()) {
        check(cudaHostGetDevicePointer(&mapped_, host_, 0), "mapping " + what);
    } else {
        twin_ = DeviceMemory(bytes, what);
    }
}

ExchangeMemory::~ExchangeMemory() {
    static_cast<void>(cudaFreeHost(host_));
}

ExchangeMemory::ExchangeMemory(ExchangeMemory&& other) noexcept {
    *this = std::move(other);
}

ExchangeMemory& ExchangeMemory::operator=(ExchangeMemory&& other) noexcept {
    std::swap(size_, other.size_);
    std::swap(host_, other.host_);
    std::swap(mapped_, other.mapped_);
    std::swap(twin_, other.twin_);
    return *this;
}

void ExchangeMemory::to_device(const Stream& stream) const {
    if (mapped_ == nullptr) {
        check(cudaMemcpyAsync(twin_.as<void>(), host_, size_, cudaMemcpyHostToDevice, stream.get()),
              "copying to the device");
    }
}

void ExchangeMemory::to_host(const Stream& stream) const {
    if (mapped_ == nullptr) {
        check(cudaMemcpyAsync(host_, twin_.as<void>(), size_, cudaMemcpyDeviceToHost, stream.get()),
              "copying from the device");
    }
}

StreamClock::StreamClock(std::size_t marks) : StreamClock() {
    events_.reserve(marks);
    while (events_.size() < marks) {
        cudaEvent_t event = nullptr;
        check(cudaEventCreate(&event), "creating an event");
        events_.push_back(event);
    }
}

StreamClock::~StreamClock() {
    for (const cudaEvent_t event : events_) {
        static_cast<void>(cudaEventDestroy(event));
    }
}

void StreamClock::mark(std::size_t i, const Stream& stream) const {
    cudaStreamCaptureStatus capture = cudaStreamCaptureStatusNone;
    check(cudaStreamIsCapturing(stream.get(), &capture), "taking the time");
    const unsigned flags = capture == cudaStreamCaptureStatusActive ? cudaEventRecordExternal : cudaEventRecordDefault;
    check(cudaEventRecordWithFlags(events_[i], stream.get(), flags), "taking the time");
}

std::chrono::nanoseconds StreamClock::after(std::size_t i) const {
    float milliseconds = 0;
    check(cudaEventElapsedTime(&milliseconds, events_[i], events_[i + 1]), "taking the time");
    return std::chrono::nanoseconds(static_cast<std::int64_t>(static_cast<double>(milliseconds) * 1e6));
}

}  // namespace disparityd::cuda
