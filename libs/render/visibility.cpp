#include "render/visibility.h"

#define GL_GLEXT_PROTOTYPES  // for the functions' types: they are found at run time, never linked
#include <GL/osmesa.h>
//
#include <GL/glext.h>

#include <stdexcept>
#include <string>

#ifdef FATHOM_SANITIZE
// OSMesa 22.3 never frees the window buffer of a context (some 150 bytes each). What it allocates is not
// reported as a leak, in any program that this file is linked into; what we allocate is.
extern "C" const char* __lsan_default_suppressions();                                   // NOLINT
extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa.so\n"; }  // NOLINT
extern "C" const char* __lsan_default_options();                                        // NOLINT
extern "C" const char* __lsan_default_options() { return "print_suppressions=0"; }      // NOLINT
#endif

namespace fathom {
namespace {

constexpr double kNearest_m = 0.01;

template <class Function>
Function load(const char* name) {
  const auto function = OSMesaGetProcAddress(name);
  if (!function) throw std::runtime_error(std::string("OSMesa has no ") + name);
  return reinterpret_cast<Function>(function);
}

// NOLINTNEXTLINE(bugprone-macro-parentheses): a declared name takes none
#define FATHOM_GL(name) decltype(&::gl##name) name = load<decltype(&::gl##name)>("gl" #name)
struct Gl {
  FATHOM_GL(AttachShader);
  FATHOM_GL(BindBuffer);
  FATHOM_GL(BindFramebuffer);
  FATHOM_GL(BindRenderbuffer);
  FATHOM_GL(BindVertexArray);
  FATHOM_GL(BufferData);
  FATHOM_GL(CheckFramebufferStatus);
  FATHOM_GL(ClearBufferfv);
  FATHOM_GL(ClearBufferuiv);
  FATHOM_GL(ClipControl);
  FATHOM_GL(CompileShader);
  FATHOM_GL(CreateProgram);
  FATHOM_GL(CreateShader);
  FATHOM_GL(DepthFunc);
  FATHOM_GL(DrawElements);
  FATHOM_GL(Enable);
  FATHOM_GL(EnableVertexAttribArray);
  FATHOM_GL(FramebufferRenderbuffer);
  FATHOM_GL(GenBuffers);
  FATHOM_GL(GenFramebuffers);
  FATHOM_GL(GenRenderbuffers);
  FATHOM_GL(GenVertexArrays);
  FATHOM_GL(GetError);
  FATHOM_GL(GetProgramiv);
  FATHOM_GL(GetString);
  FATHOM_GL(GetUniformLocation);
  FATHOM_GL(LinkProgram);
  FATHOM_GL(ReadPixels);
  FATHOM_GL(RenderbufferStorage);
  FATHOM_GL(ShaderSource);
  FATHOM_GL(UniformMatrix4fv);
  FATHOM_GL(UseProgram);
  FATHOM_GL(VertexAttribPointer);
  FATHOM_GL(Viewport);
};
#undef FATHOM_GL

constexpr const char* kVertexShader = R"(#version 330 core
layout(location = 0) in vec3 position_odom;
uniform mat4 clip_odom;
void main() { gl_Position = clip_odom * vec4(position_odom, 1.0); }
)";

constexpr const char* kFragmentShader = R"(#version 330 core
out uint triangle;
void main() { triangle = uint(gl_PrimitiveID) + 1u; }
)";

/// Camera frame to GL's clip coordinates, so that sample (column, row) falls on the middle of pixel
/// (column, row), the first row of GL's image being our top. Depth is nearest/z: float has its finest steps
/// where this is small, so that a marker stands clear of the face 1 mm behind it however far away both are.
Eigen::Matrix4d projectionOf(const Raster& raster) {
  const double columns = raster.columns, rows = raster.rows;
  Eigen::Matrix4d clip_camera = Eigen::Matrix4d::Zero();
  clip_camera(0, 0) = 2.0 / (columns * raster.step_x);
  clip_camera(0, 2) = (1.0 - 2.0 * raster.x0 / raster.step_x) / columns - 1.0;
  clip_camera(1, 1) = 2.0 / (rows * raster.step_y);
  clip_camera(1, 2) = (1.0 - 2.0 * raster.y0 / raster.step_y) / rows - 1.0;
  clip_camera(2, 3) = kNearest_m;
  clip_camera(3, 2) = 1.0;
  return clip_camera;
}

struct ContextDeleter {
  void operator()(OSMesaContext context) const { OSMesaDestroyContext(context); }
};
using ContextHandle = std::unique_ptr<std::remove_pointer_t<OSMesaContext>, ContextDeleter>;

ContextHandle createContext() {
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            3,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  ContextHandle context(OSMesaCreateContextAttribs(attributes, nullptr));
  if (!context) throw std::runtime_error("OSMesa gives no GL 3.3 core context");
  return context;
}

}  // namespace

struct VisibilityBuffer::Context {
  Raster raster;  // with as many rows as are drawn at a time, from the top
  std::vector<std::uint32_t> triangles;
  GLsizei index_count = 0;
  GLint clip_odom = 0;          // the uniform's place
  std::uint8_t window[4] = {};  // OSMesa insists on one; the drawing goes to a framebuffer object
  ContextHandle handle = createContext();
  std::unique_ptr<const Gl> gl;

  Context(const Raster& all, int rows) : raster(all) {
    raster.rows = rows;
    triangles.resize(raster.size());
    const Current current(*this);
    gl = std::make_unique<const Gl>();
    // A context without a version is one that draws nothing and reports no error.
    if (!gl->GetString(GL_VERSION)) throw std::runtime_error("OSMesa gives a context without GL");
    createFramebuffer();
    createProgram();
    createBuffers();
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(GL_GREATER);
    gl->ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl->Viewport(0, 0, raster.columns, raster.rows);
    check("the set-up");
  }

  /// Makes the context this thread's for as long as it lives, so that any thread can use it next.
  struct Current {
    explicit Current(Context& context) {
      if (!OSMesaMakeCurrent(context.handle.get(), context.window, GL_UNSIGNED_BYTE, 1, 1))
        throw std::runtime_error("OSMesa cannot make its context current");
    }
    ~Current() { OSMesaMakeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;
  };

  void check(const char* what) const {
    if (const GLenum error = gl->GetError(); error != GL_NO_ERROR)
      throw std::runtime_error(std::string("GL error ") + std::to_string(error) + " in " + what);
  }

  void createFramebuffer() const {
    GLuint framebuffer = 0;
    gl->GenFramebuffers(1, &framebuffer);
    gl->BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    attach(GL_COLOR_ATTACHMENT0, GL_R32UI);
    attach(GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT32F);
    if (gl->CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      throw std::runtime_error("OSMesa gives no raster of " + std::to_string(raster.columns) + " x " +
                               std::to_string(raster.rows) + " samples");
  }

  void attach(GLenum attachment, GLenum format) const {
    GLuint buffer = 0;
    gl->GenRenderbuffers(1, &buffer);
    gl->BindRenderbuffer(GL_RENDERBUFFER, buffer);
    gl->RenderbufferStorage(GL_RENDERBUFFER, format, raster.columns, raster.rows);
    gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
  }

  void createProgram() {
    const GLuint program = gl->CreateProgram();
    for (const auto& [kind, source] : {std::pair<GLenum, const char*>(GL_VERTEX_SHADER, kVertexShader),
                                       std::pair<GLenum, const char*>(GL_FRAGMENT_SHADER, kFragmentShader)}) {
      const GLuint shader = gl->CreateShader(kind);
      gl->ShaderSource(shader, 1, &source, nullptr);
      gl->CompileShader(shader);
      gl->AttachShader(program, shader);
    }
    gl->LinkProgram(program);
    GLint linked = GL_FALSE;
    gl->GetProgramiv(program, GL_LINK_STATUS, &linked);
    if (!linked) throw std::runtime_error("OSMesa cannot compile the shaders");
    gl->UseProgram(program);
    clip_odom = gl->GetUniformLocation(program, "clip_odom");
  }

  void createBuffers() const {
    GLuint vertex_array = 0;
    gl->GenVertexArrays(1, &vertex_array);
    gl->BindVertexArray(vertex_array);
    GLuint buffers[2] = {};
    gl->GenBuffers(2, buffers);
    gl->BindBuffer(GL_ARRAY_BUFFER, buffers[0]);
    gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
    static_assert(offsetof(Surface::Vertex, position) == 0);
    gl->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Surface::Vertex), nullptr);
    gl->EnableVertexAttribArray(0);
  }
};

VisibilityBuffer::VisibilityBuffer(const Raster& raster, int rows)
    : context_(std::make_unique<Context>(raster, rows)) {}
VisibilityBuffer::~VisibilityBuffer() = default;
VisibilityBuffer::VisibilityBuffer(VisibilityBuffer&&) noexcept = default;
VisibilityBuffer& VisibilityBuffer::operator=(VisibilityBuffer&&) noexcept = default;

void VisibilityBuffer::setScene(const Surface& surface_odom) {
  const Context::Current current(*context_);
  const Gl& gl = *context_->gl;
  const auto bytes = [](const auto& values) {
    return static_cast<GLsizeiptr>(values.size() * sizeof(values.front()));
  };
  gl.BufferData(GL_ARRAY_BUFFER, bytes(surface_odom.vertices), surface_odom.vertices.data(), GL_DYNAMIC_DRAW);
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, bytes(surface_odom.triangles), surface_odom.triangles.data(),
                GL_DYNAMIC_DRAW);
  context_->index_count = static_cast<GLsizei>(3 * surface_odom.triangles.size());
  context_->check("a scene");
}

const std::vector<std::uint32_t>& VisibilityBuffer::draw(const Pose& T_camera_odom, int first_row) {
  const Context::Current current(*context_);
  const Gl& gl = *context_->gl;
  Eigen::Matrix4d camera_odom = Eigen::Matrix4d::Identity();
  camera_odom.topLeftCorner<3, 3>() = T_camera_odom.rotation;
  camera_odom.topRightCorner<3, 1>() = T_camera_odom.position;
  Raster drawn = context_->raster;
  drawn.y0 += first_row * drawn.step_y;
  const Eigen::Matrix4f clip_odom = (projectionOf(drawn) * camera_odom).cast<float>();
  gl.UniformMatrix4fv(context_->clip_odom, 1, GL_FALSE, clip_odom.data());

  constexpr GLuint kNothing[4] = {};
  constexpr GLfloat kInfinitelyFar = 0;
  gl.ClearBufferuiv(GL_COLOR, 0, kNothing);
  gl.ClearBufferfv(GL_DEPTH, 0, &kInfinitelyFar);
  if (context_->index_count > 0)
    gl.DrawElements(GL_TRIANGLES, context_->index_count, GL_UNSIGNED_INT, nullptr);
  gl.ReadPixels(0, 0, context_->raster.columns, context_->raster.rows, GL_RED_INTEGER, GL_UNSIGNED_INT,
                context_->triangles.data());
  context_->check("a drawing");
  return context_->triangles;
}

}  // namespace fathom
