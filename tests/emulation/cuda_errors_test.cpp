// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/emulation/thoroughness.h"
#include "tests/emulation/with_settings.h"
#include "tests/kernels/support.h"

// What people are told when the GPU is not as it should be.
namespace disparityd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const Backend& cuda_row() {
    return backends().front();
}

std::string refusal(const simt::Machine& state) {
    const WithMachine machine(state);
    EXPECT_FALSE(cuda_row().available());
    EXPECT_EQ(backend("auto").name, "cpu");
    try {
        backend("cuda");
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "taken";
}

TEST(EmulatedCudaErrors, TheTableTakesTheGpuFirstWhereThereIsOne) {
    EXPECT_EQ(cuda_row().name, "cuda");
    EXPECT_TRUE(cuda_row().available());
    EXPECT_EQ(cuda_row().unavailable_because(), "");
    EXPECT_EQ(backend("auto").name, "cuda");
}

TEST(EmulatedCudaErrors, NoDriver) {
    simt::Machine machine;
    machine.driver_version = 0;
    EXPECT_THAT(refusal(machine), AllOf(HasSubstr("\"cuda\""), HasSubstr("no NVIDIA driver"), HasSubstr("cpu")));
}

TEST(EmulatedCudaErrors, ADriverThatIsTooOld) {
    simt::Machine machine;
    machine.driver_version = 11040;
    EXPECT_THAT(refusal(machine), AllOf(HasSubstr("too old"), HasSubstr("11.4"), HasSubstr("13.0")));
}

TEST(EmulatedCudaErrors, NoDevice) {
    simt::Machine machine;
    machine.devices = 0;
    EXPECT_THAT(refusal(machine), HasSubstr("no GPU"));
}

TEST(EmulatedCudaErrors, NoCodeForTheDevice) {
    simt::Machine machine;
    for (const cudaError_t code : {cudaErrorInvalidDeviceFunction, cudaErrorNoKernelImageForDevice}) {
        machine.code = code;
        EXPECT_THAT(refusal(machine), AllOf(HasSubstr("9.0"), HasSubstr("CMAKE_CUDA_ARCHITECTURES=90")));
    }
}

TEST(EmulatedCudaErrors, ADeviceThatIsFullIsNotOneWithoutCode) {
    simt::Machine machine;
    machine.code = cudaErrorMemoryAllocation;
    EXPECT_THAT(refusal(machine), AllOf(HasSubstr("out of memory"), Not(HasSubstr("ARCHITECTURES"))));
}

TEST(EmulatedCudaErrors, CreatingWithoutAGpuSaysWhy) {
    simt::Machine none;
    none.devices = 0;
    const WithMachine machine(none);
    try {
        cuda_row().create({8, 8, default_options(Method::sgm)});
        FAIL() << "there is no device";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), HasSubstr("no GPU"));
    }
    EXPECT_THROW(cuda_row().create({0, 8, default_options(Method::sgm)}), std::invalid_argument) << "the options first";
}

TEST(EmulatedCudaErrors, TooLittleMemorySaysForWhatAndReturnsTheRest) {
    simt::Machine small;
    small.memory = 1000000;
    const WithMachine machine(small);
    const std::size_t before = simt::allocated_bytes();
    try {
        cuda_row().create({100, 90, default_options(Method::sgm, {0, 256})});
        FAIL() << "a volume of 2.3 MB does not fit into 1 MB";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), AllOf(HasSubstr("path costs"), HasSubstr("3 MB wanted"), HasSubstr("of 1 MB free"),
                                        HasSubstr("back end cpu")));
    }
    EXPECT_EQ(simt::allocated_bytes(), before);
}

TEST(EmulatedCudaErrors, WhereverTheMemoryEndsAllOfItIsReturned) {
    const std::size_t before = simt::allocated_bytes();
    const MatcherConfig config{20, 15, default_options(Method::sgm, {0, 16})};
    int refused = 0;
    bool made = false;
    for (std::size_t memory = 0; !made; memory += 997) {
        simt::Machine small;
        small.memory = before + memory;
        const WithMachine machine(small);
        try {
            cuda_row().create(config);
            made = true;
        } catch (const std::runtime_error& error) {
            EXPECT_THAT(error.what(), HasSubstr("wanted"));
            ++refused;
        }
        EXPECT_EQ(simt::allocated_bytes(), before);
    }
    EXPECT_GT(refused, 20);
}

TEST(EmulatedCudaErrors, AllMemoryIsReturnedAndNoneTakenPerFrame) {
    Random random(70);
    Serial serial;
    const std::size_t before = simt::allocated_bytes();
    {
        const auto matcher = backend("cuda").create({40, 30, default_options(Method::sgm, {0, 32})});
        const std::size_t configured = simt::allocated_bytes();
        EXPECT_GT(configured, before);
        Frame frame(*matcher, noise(random, 40, 30), noise(random, 40, 30));
        match_pair(*matcher, frame.view, serial);
        match_pair(*matcher, frame.view, serial);
        EXPECT_EQ(simt::allocated_bytes(), configured);
    }
    EXPECT_EQ(simt::allocated_bytes(), before);
}

// Wherever in the frame the device goes, it is an error with a reason, and everything is given back.
TEST(EmulatedCudaErrors, ADeviceLostInMidFrame) {
    Random random(71);
    Serial serial;
    const std::size_t before = simt::allocated_bytes();
    for (int operations = 0; operations < 12; operations += all_rounds ? 1 : 5) {
        const auto matcher = backend("cuda").create({20, 15, default_options(Method::sgm, {0, 16})});
        Frame frame(*matcher, noise(random, 20, 15), noise(random, 20, 15));
        match_pair(*matcher, frame.view, serial);
        simt::Machine failing;
        failing.operations_until_lost = operations;
        const WithMachine machine(failing);
        try {
            match_pair(*matcher, frame.view, serial);
            FAIL() << "lost after " << operations << " operations";
        } catch (const std::runtime_error& error) {
            EXPECT_THAT(error.what(), AllOf(HasSubstr("CUDA"), HasSubstr("launch failure")));
        }
        EXPECT_THROW(match_pair(*matcher, frame.view, serial), std::runtime_error);
    }
    EXPECT_EQ(simt::allocated_bytes(), before);
}

// The same on "auto": no frame is missing, all are right, and it says what happened.
TEST(EmulatedCudaErrors, WithAutoTheProcessorGoesOnWhereTheDeviceIsLost) {
    Random random(72);
    Serial serial;
    const MatchOptions options = default_options(Method::sgm, {0, 16});
    const MatcherConfig config{20, 15, options};
    const auto reference = backend("reference").create(config);
    for (const int operations : {0, 3, 7}) {
        const auto matcher = make_matcher("auto", config);
        EXPECT_EQ(matcher->trouble(), "");
        EXPECT_EQ(matcher->substitute(), "");
        simt::Machine failing;
        failing.operations_until_lost = 30 + operations;
        const WithMachine machine(failing);
        for (int i = 0; i < 5; ++i) {
            Frame frame(*matcher, noise(random, 20, 15), noise(random, 20, 15));
            Frame expected(*reference, frame.left, frame.right);
            match_pair(*matcher, frame.view, serial);
            match_pair(*reference, expected.view, serial);
            EXPECT_EQ(frame.disparity.pixels(), expected.disparity.pixels()) << "frame " << i;
            EXPECT_EQ(frame.depth.pixels(), expected.depth.pixels());
        }
        EXPECT_THAT(matcher->trouble(), AllOf(HasSubstr("launch failure"), HasSubstr("back end cpu goes on")));
        EXPECT_EQ(matcher->substitute(), "cpu");
    }
}

TEST(EmulatedCudaErrors, TheFirstStageGoesOnToo) {
    Random random(73);
    Serial serial;
    const auto matcher = make_matcher("auto", {20, 15, default_options(Method::sad, {0, 16})});
    const auto raw = noise(random, 40, 15);
    const Rectifier rectifier;
    Frame frame(*matcher, Image<std::uint8_t>(20, 15), Image<std::uint8_t>(20, 15));
    frame.view.raw = {raw.plane().data, PixelFormat::grey8, 20, 15, 40};
    frame.view.rectifier = &rectifier;
    simt::Machine failing;
    failing.operations_until_lost = 0;
    const WithMachine machine(failing);
    std::chrono::nanoseconds time{};
    matcher->run(0, frame.view, serial, {&time, 1});
    for (int y = 0; y < 15; ++y) {
        EXPECT_EQ(frame.right.at(19, y), raw.at(39, y));
    }
    const Rectifier outside{false, {}, {}, 1, 0};
    frame.view.rectifier = &outside;
    EXPECT_THROW(matcher->run(0, frame.view, serial, {&time, 1}), std::invalid_argument);
}

TEST(EmulatedCudaErrors, WithAutoTooLittleDeviceMemoryMeansTheProcessor) {
    simt::Machine small;
    small.memory = 1000000;
    const WithMachine machine(small);
    const MatcherConfig config{100, 90, default_options(Method::sgm, {0, 64})};
    const auto matcher = make_matcher("auto", config);
    EXPECT_GT(matcher->stages().size(), 2U) << "the stages of the processor's";
    EXPECT_THAT(matcher->trouble(), AllOf(HasSubstr("no memory"), HasSubstr("back end cpu is used")));
    EXPECT_EQ(matcher->substitute(), "cpu");
    EXPECT_THROW(make_matcher("cuda", config), std::runtime_error) << "by name it is wanted and nothing else";
}

}  // namespace
}  // namespace disparityd::test
