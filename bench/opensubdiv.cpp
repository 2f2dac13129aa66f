// OpenSubdiv in C++, where it is installed: from indexed faces to the points and faces of a level, as a program that answers
// lines of text (bench/src/engines/remote.rs has the other side, and the format of the files).
//
//   indexed faces ─ Far::TopologyRefinerFactory ─ RefineUniform ─ PrimvarRefiner::Interpolate, level by level ─> points
//   '─────────────────────────────────────────── timed ──────────────────────────────────────────────────────'
//
// Times are those of this thread, as for the engines in Rust. Bytes are counted in operator new, which the library uses too.
// Limit: uniform refinement on one thread; level 0 is the topology alone.

#include <malloc.h>
#include <time.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <memory>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>
#include <opensubdiv/version.h>

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

// What is allocated now and was at most, while a run is being counted.
static bool counting = false;
static int64_t held = 0, peak = 0;

// Not inlined: the compiler takes a block that comes from malloc and goes to operator delete for a mistake.
__attribute__((noinline)) void *operator new(std::size_t bytes) {
    void *block = std::malloc(bytes ? bytes : 1);
    if (!block) throw std::bad_alloc();
    if (counting) peak = std::max(peak, held += int64_t(malloc_usable_size(block)));
    return block;
}
__attribute__((noinline)) void operator delete(void *block) noexcept {
    if (counting && block) held -= int64_t(malloc_usable_size(block));
    std::free(block);
}
void operator delete(void *block, std::size_t) noexcept { operator delete(block); }

struct Point {
    float at[3];
    void Clear(void * = nullptr) { at[0] = at[1] = at[2] = 0; }
    void AddWithWeight(const Point &other, float weight) {
        for (int k = 0; k < 3; ++k) at[k] += weight * other.at[k];
    }
};

// A mesh as it lies in a file: numbers of vertices, faces, corners and creases, then arrays.
struct Mesh {
    std::vector<Point> points;
    std::vector<int> counts, corners, ends;
    std::vector<float> sharpness;
};

template <typename T> static void read(std::istream &from, std::vector<T> &into, std::size_t count) {
    into.resize(count);
    from.read(reinterpret_cast<char *>(into.data()), std::streamsize(count * sizeof(T)));
}

static Mesh load(const std::string &path) {
    std::ifstream file(path, std::ios::binary);
    std::vector<uint32_t> sizes;
    Mesh mesh;
    read(file, sizes, 4);
    read(file, mesh.points, sizes[0]);
    read(file, mesh.counts, sizes[1]);
    read(file, mesh.corners, sizes[2]);
    read(file, mesh.ends, 2 * std::size_t(sizes[3]));
    read(file, mesh.sharpness, sizes[3]);
    if (!file) throw std::runtime_error("the file " + path + " is too short");
    return mesh;
}

// What a run leaves behind.
struct Result {
    std::unique_ptr<Far::TopologyRefiner> refiner;
    std::vector<Point> points;
};

static Result refine(const Mesh &mesh, Sdc::SchemeType scheme, int level) {
    Far::TopologyDescriptor input;
    input.numVertices = int(mesh.points.size());
    input.numFaces = int(mesh.counts.size());
    input.numVertsPerFace = mesh.counts.data();
    input.vertIndicesPerFace = mesh.corners.data();
    input.numCreases = int(mesh.sharpness.size());
    input.creaseVertexIndexPairs = mesh.ends.data();
    input.creaseWeights = mesh.sharpness.data();
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    Result result;
    result.refiner.reset(Factory::Create(input, Factory::Options(scheme, options)));
    if (!result.refiner) throw std::runtime_error("OpenSubdiv does not take the mesh");
    result.refiner->RefineUniform(Far::TopologyRefiner::UniformOptions(level));
    Far::PrimvarRefiner primvar(*result.refiner);
    const Point *coarse = mesh.points.data();
    for (int k = 1; k <= level; ++k) {
        std::vector<Point> fine(std::size_t(result.refiner->GetLevel(k).GetNumVertices()));
        Point *to = fine.data();
        primvar.Interpolate(k, coarse, to);
        result.points = std::move(fine);
        coarse = result.points.data();
    }
    return result;
}

static double now() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

template <typename T> static void write(std::ostream &to, const T *from, std::size_t count) {
    to.write(reinterpret_cast<const char *>(from), std::streamsize(count * sizeof(T)));
}

static void save(const Mesh &mesh, const Result &result, const std::string &path) {
    const Far::TopologyLevel &level = result.refiner->GetLevel(result.refiner->GetMaxLevel());
    const std::vector<Point> &points = result.refiner->GetMaxLevel() == 0 ? mesh.points : result.points;
    std::vector<uint32_t> counts, corners;
    for (int f = 0; f < level.GetNumFaces(); ++f) {
        Far::ConstIndexArray face = level.GetFaceVertices(f);
        counts.push_back(uint32_t(face.size()));
        for (int i = 0; i < face.size(); ++i) corners.push_back(uint32_t(face[i]));
    }
    const uint32_t sizes[4] = {uint32_t(points.size()), uint32_t(counts.size()), uint32_t(corners.size()), 0};
    std::ofstream file(path, std::ios::binary);
    write(file, sizes, 4);
    write(file, points.data(), points.size());
    write(file, counts.data(), counts.size());
    write(file, corners.data(), corners.size());
    if (!file) throw std::runtime_error("the file " + path + " cannot be written");
}

// One command: what is to be answered behind `ok`; the reason why not is thrown.
static std::string answer(std::istringstream &words, Mesh &mesh, Sdc::SchemeType &scheme, int &level) {
    std::string command, engine, path;
    words >> command >> engine;
    if (command == "prepare") {
        std::string id;
        words >> id >> level >> path;
        if (id == "catmull-clark") scheme = Sdc::SCHEME_CATMARK;
        else if (id == "loop") scheme = Sdc::SCHEME_LOOP;
        else if (id == "linear") scheme = Sdc::SCHEME_BILINEAR;
        else throw std::runtime_error("there is no such scheme");
        mesh = load(path);
        // Its bilinear scheme quarters polygons; Limn's linear one keeps triangles.
        const bool quads = std::all_of(mesh.counts.begin(), mesh.counts.end(), [](int n) { return n == 4; });
        if (id == "linear" && !quads) throw std::runtime_error("bilinear is another split on these faces");
        return "";
    }
    if (command == "run") {
        int repeats = 1;
        words >> repeats;
        const double start = now();
        for (int i = 0; i < repeats; ++i) refine(mesh, scheme, level);
        char text[32];
        std::snprintf(text, sizeof text, "%.9f", now() - start);
        return text;
    }
    if (command == "peak") {
        held = peak = 0;
        counting = true;
        refine(mesh, scheme, level);
        counting = false;
        return std::to_string(peak);
    }
    if (command == "surface") {
        words >> path;
        save(mesh, refine(mesh, scheme, level), path);
        return "";
    }
    if (command == "free") {
        mesh = Mesh();
        return "";
    }
    throw std::runtime_error("there is no such command");
}

int main() {
    Mesh mesh;
    Sdc::SchemeType scheme = Sdc::SCHEME_CATMARK;
    int level = 0;
    std::cout << "engine opensubdiv OpenSubdiv " << OPENSUBDIV_VERSION_MAJOR << "." << OPENSUBDIV_VERSION_MINOR << "."
              << OPENSUBDIV_VERSION_PATCH << "\nready" << std::endl;
    for (std::string line; std::getline(std::cin, line);) {
        std::istringstream words(line);
        try {
            const std::string said = answer(words, mesh, scheme, level);
            std::cout << "ok " << said << std::endl;
        } catch (const std::exception &error) {
            std::cout << "no " << error.what() << std::endl;
        }
    }
}
