// SPDX-License-Identifier: Apache-2.0
#include "tests/kernels/check/kernel_case.h"

namespace disparityd::test {

std::vector<KernelCase> kernel_cases() {
    std::vector<KernelCase> all;
    for (const auto& some : {rectify_cases(), step_cases(), sgm_cases(), sweep_cases(), block_cases()}) {
        all.insert(all.end(), some.begin(), some.end());
    }
    return all;
}

ImagePair::ImagePair(Random& random, const KernelInput& input)
    : left(input.width, input.height),
      right(input.width, input.height),
      smoothed_left(input.width, input.height),
      smoothed_right(input.width, input.height) {
    const int kind = input.hostile ? pick(random, 0, 4) : 2;
    left = noise(random, input.width, input.height, 0, kind == 1 ? 1 : 255);
    right = kind == 2 ? shifted(random, left, input.hostile ? pick(random, -20, 20) : 17)
                      : noise(random, input.width, input.height);
    for (Image<std::uint8_t>* image : {&left, &right}) {
        for (std::uint8_t& pixel : image->pixels()) {
            pixel = kind == 0 ? std::uint8_t{90} : kind != 3 ? pixel : pixel < 128 ? 0 : 255;
        }
    }
    reference::smooth(left.plane(), smoothed_left.plane(), left.rows());
    reference::smooth(right.plane(), smoothed_right.plane(), right.rows());
}

}  // namespace disparityd::test
