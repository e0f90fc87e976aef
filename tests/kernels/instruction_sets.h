// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "kernels/cpu/backend.h"
#include "kernels/cpu/step_kernels.h"

namespace disparityd::test {

/// Tests of the steps as the cpu back end has them, for each instruction set of this machine.
class StepsOfInstructionSet : public testing::TestWithParam<cpu::InstructionSet> {
protected:
    const FrameSteps& steps() const { return cpu::frame_steps(GetParam().target); }
};

inline std::string name_of(const testing::TestParamInfo<cpu::InstructionSet>& instance) {
    return instance.param.name;
}

}  // namespace disparityd::test
