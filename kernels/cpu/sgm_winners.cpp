// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/sgm_winners.h"

#define HWY_TARGET_INCLUDE "kernels/cpu/sgm_winners.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "kernels/cpu/instruction_sets.h"

#define DISPARITYD_CPU_VECTORS (HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128)
#if DISPARITYD_CPU_VECTORS
#include "kernels/cpu/keyed_winner_row-inl.h"
#include "kernels/cpu/layouts-inl.h"
#include "kernels/cpu/path_offsets-inl.h"
#include "kernels/cpu/winner_row-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

template <class Tag, int registers>
struct Winners {
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));

    using KeyTag = hn::Repartition<std::uint16_t, Tag>;
    static constexpr int classes = 2 * registers;
    static constexpr int paths = 8;
    static constexpr int key_bits = 6;  // beside sums of up to 8 * 63 + 8 * 62

    static void winner(const SgmGeometry& geometry, const PostOptions& options, const std::uint8_t* down,
                       const std::uint8_t* up, const std::uint8_t* costs, const WinnerRow& out) {
        Minima minima;
        if constexpr (KeyGroups<KeyTag, classes, key_bits>::possible) {
            const auto keys = [=](int x, hn::Vec<KeyTag>* to) { keys_of(x, down, up, costs, to); };
            KeyedWinnerSearch<KeyTag, classes, key_bits, paths * raised_cost>(geometry).run(keys, minima,
                                                                                            out.right_winner);
        } else {
            const auto keys = pixel_by_pixel<registers * lanes>(
                [=](int x, std::uint16_t* to) { store_keys(x, down, up, costs, to); });
            WinnerSearch<KeyTag, classes>(geometry).run(keys, minima, out.right_winner);
        }
        LeftResults(geometry, options).row(minima, geometry.width, out);
    }

    // 64 S of pixel x, S = down + up + 8 C, in the classes of winner_row-inl.h. C and so S are still raised.
    static HWY_INLINE void keys_of(int x, const std::uint8_t* down, const std::uint8_t* up, const std::uint8_t* costs,
                                   hn::Vec<KeyTag>* out) {
        const Tag bytes;
        const KeyTag words;
        const auto high = hn::Set(words, std::uint16_t{0xff00});
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(x) * registers * lanes;
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            const auto a = hn::Load(bytes, down + at + r * lanes);
            const auto b = hn::Load(bytes, up + at + r * lanes);
            const auto c = hn::BitCast(words, hn::Load(bytes, costs + at + r * lanes));
            // 512 C: the odd byte leaves the word by itself.
            out[r] = hn::Add(sum_of_bytes<false, key_bits>(words, a, b), hn::ShiftLeft<key_bits + 3>(c));
            out[r + registers] = hn::Add(sum_of_bytes<true, key_bits>(words, a, b), hn::ShiftLeft<1>(hn::And(c, high)));
        }
    }

    // Keys of WinnerSearch, of C no longer raised.
    static HWY_INLINE void store_keys(int x, const std::uint8_t* down, const std::uint8_t* up,
                                      const std::uint8_t* costs, std::uint16_t* out) {
        const Tag bytes;
        const KeyTag words;
        const auto eightfold = hn::Set(words, std::uint16_t{8 * 63});
        const auto too_large = hn::Set(bytes, std::uint8_t{raised_cost});
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(x) * registers * lanes;
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            const auto a = hn::Load(bytes, down + at + r * lanes);
            const auto b = hn::Load(bytes, up + at + r * lanes);
            const auto c = hn::BitCast(words, hn::Sub(hn::Load(bytes, costs + at + r * lanes), too_large));
            const auto even = hn::Add(sum_of_bytes<false, 0>(words, a, b), hn::And(hn::ShiftLeft<3>(c), eightfold));
            const auto odd = hn::Add(sum_of_bytes<true, 0>(words, a, b), hn::And(hn::ShiftRight<5>(c), eightfold));
            hn::Store(key_of_sum<classes>(even, r), words, out + r * (lanes / 2));
            hn::Store(key_of_sum<classes>(odd, registers + r), words, out + (registers + r) * (lanes / 2));
        }
    }
};

inline SgmWinner winner_of(int disparities) {
    return with_layout(
        disparities, [](auto tag, auto registers) -> SgmWinner { return Winners<decltype(tag), registers()>::winner; });
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace disparityd::cpu {

SgmWinner sgm_winner(std::int64_t target, int disparities) {
    const auto built = DISPARITYD_FUNCTION_FOR(target, winner_of);
    return built != nullptr ? built(disparities) : nullptr;
}

}  // namespace disparityd::cpu
#endif
