// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/kernels/guarded.h"
#include "tests/kernels/support.h"

namespace disparityd::test {

/// What a kernel is to be run on. The same input has the same contents for every variant.
struct KernelInput {
    unsigned seed = 0;
    int width = 0;
    int height = 0;
    MatchOptions options;
    bool in_parts = true;  ///< rows in two calls, so that it shows when a kernel writes beyond its rows
    bool hostile = true;   ///< contents that have broken vector code before; else textures as cameras see them
};

/// The memory that a kernel writes, with guard values around it. Owns it.
class RunBuffers {
public:
    /// A plane, one of the results that must be equal.
    template <typename T>
    Plane<T> result(int width, int height) {
        auto plane = std::make_shared<GuardedPlane<T>>(width, height);
        intact_.push_back([plane] { return plane->intact(); });
        results_.push_back([plane](std::vector<std::uint8_t>& bytes) {
            const Plane<T> found = plane->plane();
            for (int y = 0; y < found.height; ++y) {
                append(bytes, found.row(y), static_cast<std::size_t>(found.width));
            }
        });
        return plane->plane();
    }

    /// Plain memory aligned to 64 bytes; a result when `compared`.
    template <typename T>
    std::span<T> memory(std::size_t size, bool compared = false) {
        auto memory = std::make_shared<GuardedMemory<T>>(size);
        intact_.push_back([memory] { return memory->intact(); });
        if (compared) {
            results_.push_back(
                [memory](std::vector<std::uint8_t>& bytes) { append(bytes, memory->data(), memory->size()); });
        }
        std::memset(memory->data(), 0xc3, size * sizeof(T));
        kept_.push_back(memory);
        return {memory->data(), size};
    }

    bool intact() const {
        return std::all_of(intact_.begin(), intact_.end(), [](const auto& check) { return check(); });
    }

    std::vector<std::uint8_t> results() const {
        std::vector<std::uint8_t> bytes;
        for (const auto& collect : results_) {
            collect(bytes);
        }
        return bytes;
    }

private:
    template <typename T>
    static void append(std::vector<std::uint8_t>& bytes, const T* values, std::size_t count) {
        const auto* raw = reinterpret_cast<const std::uint8_t*>(values);
        bytes.insert(bytes.end(), raw, raw + count * sizeof(T));
    }

    std::vector<std::function<bool()>> intact_;
    std::vector<std::function<void(std::vector<std::uint8_t>&)>> results_;
    std::vector<std::shared_ptr<void>> kept_;
};

/// A kernel in one variant, bound to an input.
struct KernelRun {
    std::function<void()> run;      ///< the kernel
    std::function<void()> prepare;  ///< puts back what run() changes; may be empty
    /// What must be equal for all variants, in a form that they share.
    std::function<std::vector<std::uint8_t>()> results;
    std::function<bool()> intact;  ///< whether nothing outside was written
};

/// A kernel and its variants.
struct KernelCase {
    std::string name;  ///< "steps/median3", "sgm/aggregate" ..
    /// Binds the variant for an instruction set of Highway to an input; target 0: the reference.
    std::function<KernelRun(const KernelInput& input, std::int64_t target)> bind;
    int max_p2 = 193;        ///< the largest P2 that it takes
    bool per_pixel = false;  ///< its time does not depend on the number of candidates
};

/// The case with the cost census-7x5+gradient.
inline auto with_gradient_cost(std::function<KernelRun(const KernelInput& input, std::int64_t target)> bind) {
    return [bind = std::move(bind)](const KernelInput& input, std::int64_t target) {
        KernelInput other = input;
        other.options.cost = CensusCost::census_7x5_gradient;
        return bind(other, target);
    };
}

/// The table of steps, the kernels of SGM and of its sweeps, those of block matching; all of them.
std::vector<KernelCase> step_cases();
std::vector<KernelCase> rectify_cases();
std::vector<KernelCase> sgm_cases();
std::vector<KernelCase> sweep_cases();
std::vector<KernelCase> block_cases();
std::vector<KernelCase> kernel_cases();

/// A pair of images: all equal, two values, a shifted copy, extremes, noise; or a texture and its shifted copy.
struct ImagePair {
    ImagePair(Random& random, const KernelInput& input);
    Image<std::uint8_t> left, right;
    Image<std::uint8_t> smoothed_left, smoothed_right;
};

/// Calls work(Rows) for all rows of the input, the lower part first.
template <typename Work>
void over_parts(const KernelInput& input, Work work) {
    const int middle = input.in_parts ? input.height / 3 : 0;
    work(Rows{middle, input.height});
    if (middle > 0) {
        work(Rows{0, middle});
    }
}

}  // namespace disparityd::test
