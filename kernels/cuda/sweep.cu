// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/block_sync.h"
#include "kernels/cuda/device.h"
#include "kernels/cuda/path_costs.h"
#include "kernels/cuda/strips.h"

namespace disparityd::cuda {

namespace {

// The path costs at a strip's or a warp's left edge, which its left neighbour goes on with in the next row: straight of
// the first column, against the strip's lean of the first two.
template <int packs>
struct Edge {
    PathCosts<packs> straight;
    PathCosts<packs> against[2];
};

template <int packs>
struct SharedEdge {
    U16x2 words[edge_paths][packs + 1][lanes];

    __device__ void set(int i, const PathCosts<packs>& path) {
#pragma unroll
        for (int p = 0; p < packs; ++p) {
            words[i][p][lane_index()] = path.cost[p];
        }
        words[i][packs][lane_index()] = path.least;
    }
    __device__ void get(int i, PathCosts<packs>& path) const {
#pragma unroll
        for (int p = 0; p < packs; ++p) {
            path.cost[p] = words[i][p][lane_index()];
        }
        path.least = words[i][packs][lane_index()];
    }
};

// A warp's columns of a strip, with the state of their three paths in registers. A strip leans: from row to row it
// moves on by a column. So of the diagonals one stays in its column of the strip, and all that the strip's paths go on
// with besides comes from the right. Without diagonals the columns stand upright and need nobody.
template <Cost cost, int packs, bool diagonals, bool adaptive, int columns = columns_of_warp(packs)>
class Columns {
public:
    __device__ Columns(const PathsJob& job, bool upwards)
        : job_(job),
          bounds_(job.range, width(), columns),
          penalties_(job.p1),
          upwards_(upwards),
          volume_(upwards ? job.sweep_volume[1] : job.sweep_volume[0]) {}

    // Row r of the sweep, of which the warp's first column is at x.
    __device__ void advance(int r, int x, const Edge<packs>& edge) {
        const int y = row(r);
        const bool all_inside = bounds_.all_inside(x);
        const std::ptrdiff_t row_begin = static_cast<std::ptrdiff_t>(y) * width();
        // From the last column's first candidate on.
        const WordOf<cost>* right =
            words_of<cost>(job_.words.right) + row_begin + bounds_.first_column(x + columns - 1);
        WordOf<cost> words[words_of_columns];
#pragma unroll
        for (int i = 0; i < words_of_columns; ++i) {
            words[i] = right[-i];
        }
        const std::ptrdiff_t first = row_begin + x;
        prefetch_row(r + 1, diagonals ? x + 1 : x);
        const WordOf<cost>* left = words_of<cost>(job_.words.left) + first;
        const int bytes = pixel_bytes(packs, job_.wide);
        std::uint8_t* pixel = volume_ + first * bytes;
#pragma unroll
        for (int c = 0; c < columns; ++c) {
            if (static_cast<unsigned>(x + c) >= static_cast<unsigned>(width())) {
                clear(c);
                continue;
            }
            Costs<packs> costs;
            census_costs<packs>(
                left[c], [&](int slot) { return words[columns - 1 - c + slot]; }, costs);
            if (!all_inside) {
                bounds_.limit(x + c, cost_outside<cost>, costs);
            }
            Costs<packs> added;
            continue_paths(c, {x + c, y}, costs, edge, added);
            store<packs>(pixel + c * bytes, job_.wide, added);
        }
    }

    __device__ const PathCosts<packs>& straight() const {
        return straight_[0];
    }
    __device__ const PathCosts<packs>& against(int column) const {
        return against_[column];
    }
    // A path that somebody else kept as bytes, in which idle slots are lost.
    __device__ void complete(PathCosts<packs>& path) const {
        bounds_.limit_idle(path.cost);
        find_min<packs>(path);
    }

private:
    static constexpr int words_of_columns = slots_of(packs) + columns - 1;
    static_assert(words_of_columns <= margin_words);

    __device__ int width() const {
        return job_.image.width;
    }
    __device__ int row(int r) const {
        return upwards_ ? job_.image.height - 1 - r : r;
    }

    __device__ void prefetch_row(int r, int x) const {
        const std::ptrdiff_t row_begin = static_cast<std::ptrdiff_t>(row(min(r, job_.image.height - 1))) * width();
        prefetch(words_of<cost>(job_.words.right) + row_begin + bounds_.first_column(x + columns - 1));
        prefetch(words_of<cost>(job_.words.left) + row_begin + clamp(x, 0, width() - 1));
        if constexpr (adaptive) {
            prefetch(job_.image.data + row_begin + clamp(x, 0, width() - 1));
        }
    }

    // Outside the image there is no path.
    __device__ void clear(int c) {
        straight_[c] = {};
        if constexpr (diagonals) {
            along_[c] = {};
            against_[c] = {};
        }
    }

    __device__ void continue_paths(int c, Pixel pixel, const Costs<packs>& costs, const Edge<packs>& edge,
                                   Costs<packs>& added) {
        const int previous_y = pixel.y + (upwards_ ? 1 : -1);
        const auto p2_from = [&](int x) { return adapted_p2<adaptive>(job_, {x, previous_y}, pixel); };
        if constexpr (diagonals) {
            const PathCosts<packs>& right = c + 1 < columns ? straight_[(c + 1) % columns] : edge.straight;
            const PathCosts<packs>& second_right =
                c + 2 < columns ? against_[(c + 2) % columns] : edge.against[(c + 2) % columns % 2];
            along_[c] = continued<packs>(penalties_, along_[c], costs, p2_from(pixel.x - 1));
            straight_[c] = continued<packs>(penalties_, right, costs, p2_from(pixel.x));
            against_[c] = continued<packs>(penalties_, second_right, costs, p2_from(pixel.x + 1));
        } else {
            straight_[c] = continued<packs>(penalties_, straight_[c], costs, p2_from(pixel.x));
        }
#pragma unroll
        for (int p = 0; p < packs; ++p) {
            added[p] = straight_[c].cost[p] - costs[p];
            if constexpr (diagonals) {
                added[p] += along_[c].cost[p] + against_[c].cost[p] - 2 * costs[p];
            }
        }
    }

    const PathsJob& job_;
    CandidateBounds<packs> bounds_;
    PathPenalties penalties_;
    bool upwards_;
    std::uint8_t* volume_;
    PathCosts<packs> straight_[columns];
    PathCosts<packs> along_[columns];    // the diagonal that leans as the strip does
    PathCosts<packs> against_[columns];  // the other one
};

// A block's strip. All strips of a sweep have the same width; number 0 is the rightmost.
struct Strip {
    int number;
    bool upwards;
    int x;  // of its first column in row 0
    int first_row;
    int last_row;
};

template <int packs>
__device__ Strip strip_of(int ticket, const PathsJob& job) {
    constexpr int strip_width = columns_of_strip(packs);
    const int number = ticket / 2;
    const int x = job.image.width - strip_width * (number + 1);
    const bool upwards = ticket % 2 == 1;
    return {number, upwards, x, max(0, 1 - strip_width - x), min(job.image.height, job.image.width - x)};
}

// Straight paths alone: a warp's columns need nobody's. Even blocks go downwards, odd ones upwards.
template <Cost cost, int packs, bool adaptive, int columns>
__global__ void __launch_bounds__(strip_warps* lanes, 2) straight_kernel(PathsJob job) {
    const int block = static_cast<int>(blockIdx.x);
    const int x = (block / 2 * strip_warps + warp_index()) * columns;
    Columns<cost, packs, false, adaptive, columns> paths(job, block % 2 == 1);
    const Edge<packs> nothing{};
    for (int r = 0; r < job.image.height; ++r) {
        paths.advance(r, x, nothing);
    }
}

template <Cost cost, int packs, bool adaptive, int columns>
void straight_sweep(const PathsJob& job, cudaStream_t stream) {
    const Shape shape{dim3(2 * blocks_for(job.image.width, strip_warps * columns)), dim3(lanes, strip_warps)};
    launch("straight sweep", shape, stream, straight_kernel<cost, packs, adaptive, columns>, job);
}

// Whether warps with several columns each are enough for the device: a multiprocessor has four schedulers, and one that
// has less than two warps waits for most of the time. A warp with one column has more to read for each pixel.
bool wide_warps_fill_the_device(int width, int packs) {
    return 2 * width / columns_of_warp(packs) >= 8 * multiprocessors();
}

// Where the edges of a strip lie that its left neighbour reads, a row after the other.
template <int packs>
class EdgeInMemory {
public:
    static constexpr int path_bytes = pixel_bytes(packs, false);

    __device__ EdgeInMemory(const PathsJob& job, int strip, bool upwards) : height_(job.image.height) {
        const int index = 2 * strip + (upwards ? 1 : 0);
        edges_ = job.edges + static_cast<std::size_t>(index) * static_cast<std::size_t>(height_) * edge_bytes(packs);
        rows_ = job.progress + 1 + index;
    }
    __device__ std::uint8_t* path(int r, int i) const {
        return edges_ + static_cast<std::size_t>(r) * edge_bytes(packs) + static_cast<std::size_t>(i) * path_bytes;
    }
    __device__ int* rows() const { return rows_; }

private:
    int height_;
    std::uint8_t* edges_;
    int* rows_;
};

// What the strip's last warp gets from the strip to the right.
template <int packs>
class RightNeighbour {
public:
    __device__ RightNeighbour(const PathsJob& job, const Strip& strip)
        : memory_(job, strip.number == 0 ? 0 : strip.number - 1, strip.upwards),
          last_row_(strip.number == 0 ? 0 : min(strip.last_row, job.image.width - strip.x - columns_of_strip(packs))) {}

    // As it was in row r - 1.
    template <Cost cost, bool adaptive>
    __device__ void edge(int r, const Columns<cost, packs, true, adaptive>& columns, Edge<packs>& edge) {
        if (r == 0 || r > last_row_) {
            edge = {};  // it is outside the image
            return;
        }
        if (seen_ < r) {
            seen_ = wait_for_rows(memory_.rows(), r);
        }
        load_bytes<packs>(memory_.path(r - 1, 0), edge.straight.cost);
        load_bytes<packs>(memory_.path(r - 1, 1), edge.against[0].cost);
        load_bytes<packs>(memory_.path(r - 1, 2), edge.against[1].cost);
        columns.complete(edge.straight);
        columns.complete(edge.against[0]);
        columns.complete(edge.against[1]);
    }

private:
    EdgeInMemory<packs> memory_;
    int last_row_;
    int seen_ = 0;
};

template <Cost cost, int packs, bool adaptive>
__device__ void give_edge_to_next_strip(const EdgeInMemory<packs>& memory, const Strip& strip, int r,
                                        const Columns<cost, packs, true, adaptive>& columns) {
    store_bytes<packs>(memory.path(r, 0), columns.straight().cost);
    store_bytes<packs>(memory.path(r, 1), columns.against(0).cost);
    store_bytes<packs>(memory.path(r, 2), columns.against(1).cost);
    if ((r + 1) % rows_at_once == 0 || r + 1 == strip.last_row) {
        announce_rows(memory.rows(), r + 1);
    }
}

// A strip waits only for the one whose ticket is two less. The block of that one has begun and stays on its
// multiprocessor until it has ended: however many blocks there are at a time, none waits for ever.
__device__ int draw_ticket(int* tickets) {
    DISPARITYD_SHARED(int, drawn, [1]);
    if (threadIdx.x == 0 && threadIdx.y == 0) {
        drawn[0] = atomicAdd(tickets, 1);
    }
    __syncthreads();
    return same_in_warp(drawn[0]);
}

template <Cost cost, int packs, bool adaptive>
__global__ void __launch_bounds__(strip_warps* lanes, 2) sweep_kernel(PathsJob job) {
    DISPARITYD_SHARED(SharedEdge<packs>, edges, [2][strip_warps]);
    const int warp = warp_index();
    const Strip strip = strip_of<packs>(draw_ticket(job.progress), job);
    Columns<cost, packs, true, adaptive> columns(job, strip.upwards);
    RightNeighbour<packs> neighbour(job, strip);
    const EdgeInMemory<packs> own(job, strip.number, strip.upwards);
    for (int i = 0; i < edge_paths; ++i) {
        edges[(strip.first_row + 1) % 2][warp].set(i, {});
    }
    __syncthreads();
    for (int r = strip.first_row; r < strip.last_row; ++r) {
        Edge<packs> edge;
        if (warp == strip_warps - 1) {
            neighbour.edge(r, columns, edge);
        } else {
            const SharedEdge<packs>& next = edges[(r + 1) % 2][warp + 1];
            next.get(0, edge.straight);
            next.get(1, edge.against[0]);
            next.get(2, edge.against[1]);
        }
        columns.advance(r, strip.x + r + warp * columns_of_warp(packs), edge);
        if (warp == 0) {
            give_edge_to_next_strip<cost, packs, adaptive>(own, strip, r, columns);
        } else {
            SharedEdge<packs>& shared = edges[r % 2][warp];
            shared.set(0, columns.straight());
            shared.set(1, columns.against(0));
            shared.set(2, columns.against(1));
        }
        __syncthreads();
    }
}

}  // namespace

void sweep(const PathsJob& job, cudaStream_t stream) {
    const bool diagonals = job.paths == 8;
    with_variant(job, [&](auto of_cost, auto count, auto adapts) {
        constexpr Cost cost = decltype(of_cost)::value;
        constexpr int packs = decltype(count)::value;
        constexpr bool adaptive = decltype(adapts)::value;
        if (diagonals) {
            const int strips = strips_of_sweep(job.image.width, job.image.height, packs);
            const Shape shape{dim3(static_cast<unsigned>(2 * strips)), dim3(lanes, strip_warps)};
            const std::size_t bytes = static_cast<std::size_t>(1 + 2 * strips) * sizeof(int);
            check(cudaMemsetAsync(job.progress, 0, bytes, stream), "forgetting the progress of the previous frame");
            launch("sweep", shape, stream, sweep_kernel<cost, packs, adaptive>, job);
        } else if (wide_warps_fill_the_device(job.image.width, packs)) {
            straight_sweep<cost, packs, adaptive, columns_of_warp(packs)>(job, stream);
        } else {
            straight_sweep<cost, packs, adaptive, 1>(job, stream);
        }
    });
}

}  // namespace disparityd::cuda
