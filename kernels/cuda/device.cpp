// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/device.h"

#include <stdexcept>

#include "kernels/cuda/steps.h"

namespace disparityd::cuda {

namespace {

std::string version(int number) {
    return std::to_string(number / 1000) + "." + std::to_string(number % 1000 / 10);
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

int multiprocessors() {
    int count = 0;
    check(cudaDeviceGetAttribute(&count, cudaDevAttrMultiProcessorCount, 0), "properties of the device");
    return count;
}

}  // namespace disparityd::cuda
