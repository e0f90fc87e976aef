// SPDX-License-Identifier: Apache-2.0
#include "tests/emulation/runtime_api.h"

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "tests/emulation/simt.h"

namespace disparityd::simt {

using Operations = std::vector<std::function<void()>>;

struct Stream {
    Operations waiting;
    Graph* captured = nullptr;  ///< where what is asked of it goes instead
};

struct Event {
    std::chrono::steady_clock::time_point time;
    bool usable = true;  ///< not one that only orders the operations of a graph
};

struct Graph {
    Operations operations;
};

namespace {

constexpr int runtime_version = 13000;

// Every buffer an allocation of its own.
class Buffers {
public:
    void* allocate(std::size_t bytes) {
        const std::lock_guard lock(mutex_);
        if (total_ + bytes > machine().memory) {
            return nullptr;
        }
        void* memory = std::malloc(bytes);
        std::memset(memory, settings().poison, bytes);
        sizes_[memory] = bytes;
        total_ += bytes;
        return memory;
    }
    bool release(void* memory) {
        const std::lock_guard lock(mutex_);
        const auto found = sizes_.find(memory);
        if (found == sizes_.end()) {
            return memory == nullptr;
        }
        total_ -= found->second;
        sizes_.erase(found);
        std::free(memory);
        return true;
    }
    std::size_t total() {
        const std::lock_guard lock(mutex_);
        return total_;
    }

private:
    std::mutex mutex_;
    std::map<void*, std::size_t> sizes_;
    std::size_t total_ = 0;
};

Buffers& buffers() {
    static Buffers all;
    return all;
}

std::mutex lost_mutex;

bool lost() {
    const std::lock_guard lock(lost_mutex);
    return machine().operations_until_lost == 0;
}

void count_operation() {
    const std::lock_guard lock(lost_mutex);
    int& left = machine().operations_until_lost;
    left -= left > 0 ? 1 : 0;
}

// What every call answers first.
cudaError_t state() {
    if (machine().driver_version < runtime_version) {
        return cudaErrorInsufficientDriver;
    }
    if (machine().devices == 0) {
        return cudaErrorNoDevice;
    }
    return lost() ? cudaErrorLaunchFailure : cudaSuccess;
}

cudaError_t allocate(void** memory, std::size_t bytes) {
    if (state() != cudaSuccess) {
        return state();
    }
    *memory = buffers().allocate(bytes);
    return *memory == nullptr ? cudaErrorMemoryAllocation : cudaSuccess;
}

template <typename T>
cudaError_t create(T** object) {
    if (state() != cudaSuccess) {
        return state();
    }
    *object = new T;
    return cudaSuccess;
}

}  // namespace

Machine& machine() {
    static Machine all;
    return all;
}

std::size_t allocated_bytes() {
    return buffers().total();
}

void enqueue(Stream* stream, std::function<void()> operation) {
    (stream->captured != nullptr ? stream->captured->operations : stream->waiting).push_back(std::move(operation));
}

}  // namespace disparityd::simt

namespace simt = disparityd::simt;

const char* cudaGetErrorString(cudaError_t error) {
    switch (error) {
        case cudaSuccess: return "no error";
        case cudaErrorInvalidValue: return "invalid argument";
        case cudaErrorMemoryAllocation: return "out of memory";
        case cudaErrorInsufficientDriver: return "CUDA driver version is insufficient for CUDA runtime version";
        case cudaErrorNoDevice: return "no CUDA-capable device is detected";
        case cudaErrorInvalidDeviceFunction: return "invalid device function";
        case cudaErrorNoKernelImageForDevice: return "no kernel image is available for execution on the device";
        case cudaErrorLaunchFailure: return "unspecified launch failure";
        case cudaErrorNotSupported: return "operation not supported";
        case cudaErrorStreamCaptureUnsupported: return "operation not permitted when stream is capturing";
        case cudaErrorCapturedEvent: return "operation not permitted on an event last recorded in a capturing stream";
    }
    return "unknown";
}

cudaError_t cudaGetLastError() {
    return simt::state();
}

cudaError_t cudaGetDeviceCount(int* count) {
    *count = simt::state() == cudaSuccess ? simt::machine().devices : 0;
    return simt::state();
}

cudaError_t cudaDriverGetVersion(int* version) {
    *version = simt::machine().driver_version;
    return cudaSuccess;
}

cudaError_t cudaRuntimeGetVersion(int* version) {
    *version = simt::runtime_version;
    return cudaSuccess;
}

cudaError_t cudaDeviceGetAttribute(int* value, cudaDeviceAttr attribute, int /*device*/) {
    switch (attribute) {
        case cudaDevAttrMultiProcessorCount: *value = simt::machine().multiprocessors; break;
        case cudaDevAttrIntegrated: *value = simt::machine().integrated ? 1 : 0; break;
        case cudaDevAttrCanMapHostMemory: *value = 1; break;
        case cudaDevAttrComputeCapabilityMajor: *value = 9; break;
        case cudaDevAttrComputeCapabilityMinor: *value = 0; break;
    }
    return simt::state();
}

cudaError_t cudaMemGetInfo(std::size_t* free, std::size_t* total) {
    *total = simt::machine().memory;
    *free = *total - simt::allocated_bytes();
    return simt::state();
}

cudaError_t cudaMalloc(void** memory, std::size_t bytes) {
    return simt::allocate(memory, bytes);
}

cudaError_t cudaFree(void* memory) {
    return simt::buffers().release(memory) ? simt::state() : cudaErrorInvalidValue;
}

cudaError_t cudaHostAlloc(void** memory, std::size_t bytes, unsigned /*flags*/) {
    return simt::allocate(memory, bytes);
}

cudaError_t cudaFreeHost(void* memory) {
    return cudaFree(memory);
}

cudaError_t cudaHostGetDevicePointer(void** device, void* host, unsigned /*flags*/) {
    *device = host;
    return simt::state();
}

cudaError_t cudaStreamCreateWithFlags(cudaStream_t* stream, unsigned /*flags*/) {
    return simt::create(stream);
}

cudaError_t cudaStreamDestroy(cudaStream_t stream) {
    delete stream;
    return simt::state();
}

cudaError_t cudaStreamSynchronize(cudaStream_t stream) {
    if (stream->captured != nullptr) {
        return cudaErrorStreamCaptureUnsupported;
    }
    simt::Operations operations;
    operations.swap(stream->waiting);
    for (const auto& operation : operations) {
        if (simt::state() != cudaSuccess) {
            break;
        }
        operation();
        simt::count_operation();
    }
    return simt::state();
}

cudaError_t cudaMemcpyAsync(void* to, const void* from, std::size_t bytes, cudaMemcpyKind /*kind*/,
                            cudaStream_t stream) {
    simt::enqueue(stream, [=] { std::memcpy(to, from, bytes); });
    return simt::state();
}

cudaError_t cudaMemsetAsync(void* memory, int value, std::size_t bytes, cudaStream_t stream) {
    simt::enqueue(stream, [=] { std::memset(memory, value, bytes); });
    return simt::state();
}

cudaError_t cudaEventCreate(cudaEvent_t* event) {
    return simt::create(event);
}

cudaError_t cudaEventDestroy(cudaEvent_t event) {
    delete event;
    return simt::state();
}

cudaError_t cudaEventRecordWithFlags(cudaEvent_t event, cudaStream_t stream, unsigned flags) {
    const bool captured = stream->captured != nullptr;
    if (flags == cudaEventRecordExternal && !captured) {
        return cudaErrorInvalidValue;
    }
    event->usable = !captured || flags == cudaEventRecordExternal;
    simt::enqueue(stream, [event] { event->time = std::chrono::steady_clock::now(); });
    return simt::state();
}

cudaError_t cudaEventElapsedTime(float* milliseconds, cudaEvent_t start, cudaEvent_t end) {
    if (!start->usable || !end->usable) {
        return cudaErrorCapturedEvent;
    }
    *milliseconds = std::chrono::duration<float, std::milli>(end->time - start->time).count();
    return simt::state();
}

cudaError_t cudaStreamBeginCapture(cudaStream_t stream, cudaStreamCaptureMode /*mode*/) {
    if (!simt::machine().graphs) {
        return cudaErrorNotSupported;
    }
    return stream->captured != nullptr ? cudaErrorInvalidValue : simt::create(&stream->captured);
}

cudaError_t cudaStreamIsCapturing(cudaStream_t stream, cudaStreamCaptureStatus* status) {
    *status = stream->captured != nullptr ? cudaStreamCaptureStatusActive : cudaStreamCaptureStatusNone;
    return simt::state();
}

cudaError_t cudaStreamEndCapture(cudaStream_t stream, cudaGraph_t* graph) {
    *graph = std::exchange(stream->captured, nullptr);
    return simt::state();
}

cudaError_t cudaGraphInstantiateWithFlags(cudaGraphExec_t* executable, cudaGraph_t graph,
                                          unsigned long long /*flags*/) {
    const cudaError_t created = simt::create(executable);
    if (created == cudaSuccess) {
        (*executable)->operations = graph->operations;
    }
    return created;
}

cudaError_t cudaGraphLaunch(cudaGraphExec_t executable, cudaStream_t stream) {
    for (const auto& operation : executable->operations) {
        simt::enqueue(stream, operation);
    }
    return simt::state();
}

cudaError_t cudaGraphDestroy(cudaGraph_t graph) {
    delete graph;
    return simt::state();
}

cudaError_t cudaGraphExecDestroy(cudaGraphExec_t executable) {
    delete executable;
    return simt::state();
}
