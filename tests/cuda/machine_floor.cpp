// SPDX-License-Identifier: Apache-2.0
#include "tests/cuda/machine_floor.h"

#include "kernels/cuda/device.h"
#include "kernels/cuda/memory.h"
#include "tests/cuda/event_times.h"
#include "tests/cuda/minima.h"

namespace disparityd::test {

namespace {

double copied_bytes_per_second(const cuda::Stream& stream) {
    constexpr std::size_t bytes = std::size_t{256} << 20;
    const cuda::DeviceMemory from(bytes, "the copy that is timed");
    const cuda::DeviceMemory to(bytes, "the copy that is timed");
    return 2.0 * bytes / seconds_of(stream, [&](int) {
               cuda::check(
                   cudaMemcpyAsync(to.as<void>(), from.as<void>(), bytes, cudaMemcpyDeviceToDevice, stream.get()),
                   "the copy that is timed");
           });
}

double minima_per_second(Minimum way, const cuda::Stream& stream) {
    constexpr int blocks = 4096;
    constexpr int rounds = 512;
    constexpr std::size_t threads = std::size_t{blocks} * minima_threads;
    const cuda::DeviceMemory out(threads * sizeof(std::uint32_t), "minima");
    return static_cast<double>(threads) * rounds * minima_chains / seconds_of(stream, [&](int) {
               take_minima(way, blocks, rounds, 0x12341678, out.as<std::uint32_t>(), stream.get());
           });
}

}  // namespace

MachineFloor measure_floor() {
    const cuda::Stream stream;
    return {copied_bytes_per_second(stream), minima_per_second(Minimum::as_integers, stream),
            minima_per_second(Minimum::as_f16, stream), minima_per_second(Minimum::of_sum, stream)};
}

}  // namespace disparityd::test
