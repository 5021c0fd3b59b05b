// Reads mesh files. Broken ones make Assimp write where it may not, ask for gigabytes, or never end (of 150 copies of a
// small PLY file with one damaged byte or line 67 crashed it). A child process reads the file, therefore, and passes
// the triangles on through a pipe; this process believes nothing that it is told. Only this file uses Assimp.
#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/sim/triangle_mesh.hpp>
#include <new>
#include <poll.h>
#include <span>
#include <stdexcept>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ISOBATH_SHADOW_MEMORY 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define ISOBATH_SHADOW_MEMORY 1
#endif
#endif

namespace isobath {
namespace {

using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr double kMegabyte = 1e6;
constexpr double kMemory_mb = 512, kMemoryPerByte = 256;  // of the child, beyond what it has from its parent
constexpr double kCpu_s = 3, kCpuPerMegabyte_s = 10;
constexpr int kSilent_ms = 300'000;  // the limit of processor time does not end a child that waits
constexpr std::size_t kMaxText = 200;

/// What the child writes first. Then come either the text of an error, or the vertices and the triangles.
struct Head {
  std::uint64_t vertices = 0, triangles = 0;
};

struct Limits {
  double memory_mb = 0, cpu_s = 0;
};

Limits limits_for(const std::string& file) {
  std::error_code failed;
  const std::uintmax_t size = std::filesystem::file_size(file, failed);
  const double bytes = failed ? 0 : static_cast<double>(size);
  return {kMemory_mb + kMemoryPerByte * bytes / kMegabyte, kCpu_s + kCpuPerMegabyte_s * bytes / kMegabyte};
}

// In the child -------------------------------------------------------------------------------------------------------

void limit(int what, double value) {
  const rlimit bound{static_cast<rlim_t>(value), static_cast<rlim_t>(value)};
  ::setrlimit(static_cast<__rlimit_resource>(what), &bound);
}

#ifdef ISOBATH_SHADOW_MEMORY
// A sanitizer maps terabytes of shadow: no limit on the address space can be given beside it.
void limit_memory(double) {}
#else
void limit_memory(double more_mb) {
  double pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  limit(RLIMIT_AS, pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) + more_mb * kMegabyte);
}
#endif

void take_limits(const Limits& limits) {
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, std::ceil(limits.cpu_s));
  limit_memory(limits.memory_mb);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGSEGV, SIGABRT, SIGBUS, SIGFPE}) ::signal(signal, SIG_DFL);
  const int nowhere = ::open("/dev/null", O_WRONLY);
  ::dup2(nowhere, STDERR_FILENO);
  ::dup2(nowhere, STDOUT_FILENO);
}

/// A reason in `error` if there is no mesh.
TriangleMesh read_mesh(const std::string& file, std::string& error) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                                          aiComponent_COLORS | aiComponent_TEXCOORDS |
                                                          aiComponent_MATERIALS | aiComponent_TEXTURES);
  // Assimp turns COLLADA's axes to y up; this keeps the axes of the file.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene =
      importer.ReadFile(file, aiProcess_Triangulate | aiProcess_RemoveComponent | aiProcess_PreTransformVertices |
                                  aiProcess_JoinIdenticalVertices | aiProcess_FindDegenerates);
  TriangleMesh mesh;
  if (!scene || scene->mNumMeshes == 0) {
    error = importer.GetErrorString();
    return mesh;
  }
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    const int base = static_cast<int>(mesh.vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D& p = part.mVertices[v];
      mesh.vertices.emplace_back(p.x, p.y, p.z);
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines reflect nothing
      mesh.triangles.push_back(Vector3i(static_cast<int>(face.mIndices[0]), static_cast<int>(face.mIndices[1]),
                                        static_cast<int>(face.mIndices[2])) +
                               Vector3i::Constant(base));
    }
  }
  if (mesh.triangles.empty()) error = "it has no triangles";
  return mesh;
}

void put(int pipe, const void* data, std::size_t size) {
  const auto* from = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t put = ::write(pipe, from, size);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return;
    from += put;
    size -= static_cast<std::size_t>(put);
  }
}

[[noreturn]] void be_child(const std::string& file, const Limits& limits, int pipe) {
  take_limits(limits);
  std::string error;
  TriangleMesh mesh;
  try {
    mesh = read_mesh(file, error);
  } catch (const std::bad_alloc&) {
    error = fmt::format("it asks for more than {:.0f} MB of memory", limits.memory_mb);
  } catch (const std::exception& e) {
    error = e.what();
  }
  const Head head{error.empty() ? mesh.vertices.size() : 0, error.empty() ? mesh.triangles.size() : 0};
  put(pipe, &head, sizeof head);
  if (error.empty()) {
    put(pipe, mesh.vertices.data(), mesh.vertices.size() * sizeof(Vector3f));
    put(pipe, mesh.triangles.data(), mesh.triangles.size() * sizeof(Vector3i));
  } else {
    put(pipe, error.data(), std::min(error.size(), kMaxText));
  }
  ::_exit(0);
}

// In this process ----------------------------------------------------------------------------------------------------

/// All that the child writes, up to `max` bytes.
std::vector<char> heard(int pipe, std::size_t max) {
  std::vector<char> bytes;
  std::array<char, 1 << 16> part;
  while (bytes.size() < max) {
    pollfd waits{pipe, POLLIN, 0};
    const int ready = ::poll(&waits, 1, kSilent_ms);
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) break;
    const ssize_t got = ::read(pipe, part.data(), part.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    bytes.insert(bytes.end(), part.begin(), part.begin() + got);
  }
  return bytes;
}

/// What a child process tells of the file. Throws a text if there is none.
std::vector<char> told_by_child(const std::string& file, const Limits& limits) {
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) throw std::runtime_error(std::strerror(errno));
  const pid_t child = ::fork();
  if (child == 0) be_child(file, limits, pipe[1]);
  ::close(pipe[1]);
  std::vector<char> bytes;
  int status = 0;
  if (child > 0) {
    bytes = heard(pipe[0], static_cast<std::size_t>(limits.memory_mb * kMegabyte));
    ::kill(child, SIGKILL);  // it is at its end, or is stuck
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
  }
  ::close(pipe[0]);
  if (child < 0) throw std::runtime_error("no process to read it can be started");
  if (!bytes.empty()) return bytes;
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal != SIGXCPU && signal != SIGKILL) throw std::runtime_error("it is damaged: its reader crashed");
  throw std::runtime_error(fmt::format("reading it takes more than {:.0f} s", limits.cpu_s));
}

/// Throws a text unless the bytes are those of a whole mesh.
TriangleMesh mesh_in(std::span<const char> bytes) {
  static_assert(sizeof(Vector3f) == sizeof(Vector3i));
  Head head;
  if (bytes.size() < sizeof head) throw std::runtime_error("its reader stopped");
  std::memcpy(&head, bytes.data(), sizeof head);
  bytes = bytes.subspan(sizeof head);
  if (head.triangles == 0) throw std::runtime_error(std::string(bytes.data(), bytes.size()));
  const std::uint64_t all = bytes.size() / sizeof(Vector3f);
  if (head.vertices == 0 || head.vertices > all || head.triangles != all - head.vertices)
    throw std::runtime_error("its reader stopped");
  TriangleMesh mesh;
  mesh.vertices.resize(head.vertices);
  mesh.triangles.resize(head.triangles);
  const std::size_t vertex_bytes = head.vertices * sizeof(Vector3f);
  std::memcpy(mesh.vertices.front().data(), bytes.data(), vertex_bytes);
  std::memcpy(mesh.triangles.front().data(), bytes.data() + vertex_bytes, head.triangles * sizeof(Vector3i));
  const auto count = static_cast<int>(head.vertices);
  if (std::ranges::any_of(mesh.triangles, [&](auto& t) { return t.minCoeff() < 0 || t.maxCoeff() >= count; })) {
    throw std::runtime_error("a triangle has a vertex that is not there");
  }
  return mesh;
}

}  // namespace

TriangleMesh load_mesh(const std::string& file, double scale, const Place& place) {
  try {
    TriangleMesh mesh = mesh_in(told_by_child(file, limits_for(file)));
    for (Vector3f& v : mesh.vertices) {
      v *= static_cast<float>(scale);
      if (!v.allFinite()) throw std::runtime_error("a vertex is not finite");
    }
    return mesh;
  } catch (const std::runtime_error& problem) {
    Place where = place;
    where.key += ".file";
    throw Error(fmt::format("no readable mesh: {} ({})", file, problem.what()), where);
  }
}

}  // namespace isobath
