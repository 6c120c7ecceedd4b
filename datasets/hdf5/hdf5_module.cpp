#include "datasets/hdf5/hdf5_module.hpp"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <exception>
#include <stdexcept>
#include <utility>

namespace mosbench {
namespace {

constexpr std::size_t kMostGroups = 1'000'000;
constexpr int kMostDimensions = 4;
constexpr std::size_t kLongestMark = 65'536;
constexpr hid_t kWhole = 0;  // H5S_ALL, which is a cast of C

/// Finds "No space left on device" in an error of the library.
herr_t note_reason(unsigned, const H5E_error2_t* error, void* reason) {
  constexpr std::string_view kBefore = "error message = '";
  const std::string_view said = error->desc;
  const std::size_t at = said.find(kBefore);
  if (at == std::string_view::npos) return 0;
  const std::string_view rest = said.substr(at + kBefore.size());
  *static_cast<std::string*>(reason) = rest.substr(0, rest.find('\''));
  return 0;
}

/// Returns why the system refused what the library's last call wanted; empty where it did not.
std::string reason_of_system() {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, note_reason, &reason);
  return reason.empty() ? "" : ": " + reason;
}

class Hdf5Error : public std::runtime_error {
 public:
  explicit Hdf5Error(const std::string& what) : std::runtime_error(what + reason_of_system()) {}
};

/// An object of the library, closed at the end. While an error passes it stays open: what could not
/// be written cannot be closed either, which makes libhdf5 1.10 crash.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t), const char* what) : id_(id), close_(close) {
    if (id < 0) throw Hdf5Error(std::string("libhdf5 cannot ") + what);
  }
  ~Handle() {
    if (id_ >= 0 && std::uncaught_exceptions() == 0) close_(id_);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;

  operator hid_t() const { return id_; }
  /// Returns false when closing fails, as it does on a full disk.
  bool close_now() { return close_(std::exchange(id_, -1)) >= 0; }
  void leave_open() { id_ = -1; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Keeps the library from printing errors, which it does by itself else.
void be_quiet() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

/// The library shall not lock: a file system may have no locks, or be read only.
Handle access_without_locks() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "make properties");
  H5Pset_file_locking(access, 0, 1);
  return access;
}

Handle open_to_read(const std::string& file) {
  be_quiet();
  // Plug-ins that unpack numbers may be somebody else's code.
  H5PLset_loading_state(0);
  const Handle access = access_without_locks();
  return {H5Fopen(file.c_str(), H5F_ACC_RDONLY, access), H5Fclose, "open it"};
}

struct LittleEndian {
  hid_t type;
  Hdf5Number number;
};

const auto& stored_types() {
  using Kind = Hdf5Number::Kind;
  static const std::array kTypes = {LittleEndian{H5T_IEEE_F32LE, {Kind::kReal, 4}},
                                    LittleEndian{H5T_IEEE_F64LE, {Kind::kReal, 8}},
                                    LittleEndian{H5T_STD_I8LE, {Kind::kInteger, 1}},
                                    LittleEndian{H5T_STD_I16LE, {Kind::kInteger, 2}},
                                    LittleEndian{H5T_STD_I32LE, {Kind::kInteger, 4}},
                                    LittleEndian{H5T_STD_I64LE, {Kind::kInteger, 8}},
                                    LittleEndian{H5T_STD_U8LE, {Kind::kUnsigned, 1}},
                                    LittleEndian{H5T_STD_U16LE, {Kind::kUnsigned, 2}},
                                    LittleEndian{H5T_STD_U32LE, {Kind::kUnsigned, 4}},
                                    LittleEndian{H5T_STD_U64LE, {Kind::kUnsigned, 8}}};
  return kTypes;
}

/// Returns the type in which this machine holds such numbers, and whether they are stored so.
const LittleEndian& type_of(hid_t stored, const std::string& name, bool& as_they_are) {
  const auto find = [](hid_t type) {
    return std::ranges::find_if(stored_types(),
                                [type](const auto& row) { return H5Tequal(row.type, type) > 0; });
  };
  const Handle native(H5Tget_native_type(stored, H5T_DIR_ASCEND), H5Tclose, "tell a type");
  const auto found = find(native);
  if (found == stored_types().end()) throw Hdf5Error(name + " holds no numbers of 1 to 8 bytes");
  as_they_are = find(stored) == found;
  return *found;
}

/// Takes enumerations for the integers that they are stored as.
Handle number_type(hid_t dataset) {
  Handle type(H5Dget_type(dataset), H5Tclose, "tell a type");
  if (H5Tget_class(type) != H5T_ENUM) return type;
  return {H5Tget_super(type), H5Tclose, "tell a type"};
}

/// Numbers in other files could be of any file of this machine.
void refuse_elsewhere(hid_t properties, const std::string& name) {
  if (H5Pget_layout(properties) != H5D_VIRTUAL && H5Pget_external_count(properties) == 0) return;
  throw Hdf5Error(name + " has its numbers in other files");
}

std::vector<std::uint64_t> shape_of(hid_t dataset, const std::string& name) {
  const Handle space(H5Dget_space(dataset), H5Sclose, "tell a shape");
  std::array<hsize_t, kMostDimensions> sizes{};
  const int dimensions = H5Sget_simple_extent_ndims(space);
  if (dimensions < 0 || dimensions > kMostDimensions ||
      H5Sget_simple_extent_dims(space, sizes.data(), nullptr) != dimensions) {
    throw Hdf5Error(name + " is no array of at most " + std::to_string(kMostDimensions) +
                    " dimensions");
  }
  return {sizes.begin(), sizes.begin() + dimensions};
}

/// Says which filter packed the numbers of an array if libhdf5 cannot unpack it by itself.
std::string missing_filter(hid_t dataset) {
  const Handle properties(H5Dget_create_plist(dataset), H5Pclose, "tell its filters");
  for (int i = 0; i < H5Pget_nfilters(properties); ++i) {
    std::array<char, 64> name{};
    unsigned flags = 0;
    std::size_t values = 0;
    const auto filter = H5Pget_filter2(properties, static_cast<unsigned>(i), &flags, &values,
                                       nullptr, name.size() - 1, name.data(), nullptr);
    if (filter < 0 || H5Zfilter_avail(filter) > 0) continue;
    return ": packed by the filter " + std::string(name.data()) + " (" + std::to_string(filter) +
           "), pack it by gzip or not at all";
  }
  return "";
}

Hdf5Array describe(hid_t dataset, const std::string& name) {
  Hdf5Array array;
  array.name = name;
  const Handle type = number_type(dataset);
  bool as_they_are = false;
  array.number = type_of(type, name, as_they_are).number;
  array.shape = shape_of(dataset, name);
  const Handle properties(H5Dget_create_plist(dataset), H5Pclose, "tell a layout");
  refuse_elsewhere(properties, name);
  const haddr_t at = H5Dget_offset(dataset);
  array.is_plain = as_they_are && H5Pget_layout(properties) == H5D_CONTIGUOUS && at != HADDR_UNDEF;
  array.at_bytes = array.is_plain ? at : 0;
  return array;
}

/// Follows no links to other places and files.
bool holds(hid_t group, const std::string& name) {
  H5L_info_t link{};
  return H5Lexists(group, name.c_str(), H5P_DEFAULT) > 0 &&
         H5Lget_info(group, name.c_str(), &link, H5P_DEFAULT) >= 0 && link.type == H5L_TYPE_HARD;
}

Handle open_array(hid_t group, const std::string& name) {
  return {H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, ("open " + name).c_str()};
}

Handle open_group(hid_t file, const std::string& name) {
  return {H5Gopen2(file, name.c_str(), H5P_DEFAULT), H5Gclose, ("open group " + name).c_str()};
}

herr_t collect_name(hid_t, const char* name, const H5L_info_t*, void* names) {
  auto& collected = *static_cast<std::vector<std::string>*>(names);
  collected.emplace_back(name);
  return collected.size() < kMostGroups ? 0 : -1;
}

std::vector<std::string> names_in(hid_t file) {
  std::vector<std::string> names;
  if (H5Literate(file, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, collect_name, &names) < 0) {
    throw Hdf5Error("libhdf5 cannot list its groups");
  }
  return names;
}

/// The attribute of a file that says what made it.
constexpr const char* kMark = "mosbench_mark";

std::string mark_in(hid_t file) {
  if (H5Aexists(file, kMark) <= 0) return "";
  const Handle mark(H5Aopen(file, kMark, H5P_DEFAULT), H5Aclose, "open its mark");
  const Handle type(H5Aget_type(mark), H5Tclose, "tell a type");
  const Handle space(H5Aget_space(mark), H5Sclose, "tell a shape");
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0 ||
      H5Tget_size(type) > kLongestMark || H5Sget_simple_extent_npoints(space) != 1) {
    throw Hdf5Error(std::string("its attribute ") + kMark + " is no text of fixed length");
  }
  std::string text(H5Tget_size(type), '\0');
  if (H5Aread(mark, type, text.data()) < 0) throw Hdf5Error("libhdf5 cannot read its mark");
  return text.substr(0, text.find('\0'));
}

std::string list(const std::string& path, std::span<const std::string_view> wanted,
                 std::vector<Hdf5Group>& groups, std::string& mark) try {
  const Handle file = open_to_read(path);
  mark = mark_in(file);
  for (const std::string& name : names_in(file)) {
    if (!holds(file, name)) throw Hdf5Error(name + " is a link to another place");
    const Handle group = open_group(file, name);
    Hdf5Group& listed = groups.emplace_back();
    listed.name = name;
    for (const std::string_view array : wanted) {
      if (!holds(group, std::string(array))) continue;
      listed.arrays.push_back(
          describe(open_array(group, std::string(array)), name + "/" + std::string(array)));
      listed.arrays.back().name = array;
    }
  }
  return "";
} catch (const std::exception& error) {
  return error.what();
}

std::string read(const std::string& path, const std::string& group_name, const Hdf5Array& array,
                 std::string& bytes) try {
  const Handle file = open_to_read(path);
  const Handle group = open_group(file, group_name);
  const Handle dataset = open_array(group, array.name);
  const Hdf5Array now = describe(dataset, array.name);
  if (now.number != array.number || now.shape != array.shape) {
    return array.name + " is another now";
  }
  // Enumerations are read as what they are, which has the same bytes as the integers.
  const Handle stored(H5Dget_type(dataset), H5Tclose, "tell a type");
  const Handle native(H5Tget_native_type(stored, H5T_DIR_ASCEND), H5Tclose, "tell a type");
  std::size_t count = array.number.bytes;
  for (const std::uint64_t size : array.shape) count *= size;
  bytes.resize(count);
  if (count == 0) return "";
  if (H5Tget_size(native) != array.number.bytes ||
      H5Dread(dataset, native, kWhole, kWhole, H5P_DEFAULT, bytes.data()) < 0) {
    return "libhdf5 cannot read " + group_name + "/" + array.name + missing_filter(dataset);
  }
  return "";
} catch (const std::exception& error) {
  return error.what();
}

/// h5py's type of truth values.
Handle truth_type() {
  Handle type(H5Tenum_create(H5T_STD_I8LE), H5Tclose, "make a type");
  const std::int8_t no = 0, yes = 1;
  if (H5Tenum_insert(type, "FALSE", &no) < 0 || H5Tenum_insert(type, "TRUE", &yes) < 0) {
    throw Hdf5Error("libhdf5 cannot make a type");
  }
  return type;
}

Handle type_to_store(const Hdf5Number& number) {
  if (number.kind == Hdf5Number::Kind::kTruth) return truth_type();
  const auto found = std::ranges::find(stored_types(), number, &LittleEndian::number);
  return {found == stored_types().end() ? -1 : H5Tcopy(found->type), H5Tclose, "make a type"};
}

/// Without times, so that the same numbers give the same bytes.
Handle properties_without_times(hid_t of) {
  Handle properties(H5Pcreate(of), H5Pclose, "make properties");
  H5Pset_obj_track_times(properties, false);
  return properties;
}

Handle create_file(const std::string& path) {
  be_quiet();
  const Handle access = access_without_locks();
  return {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose, "write it"};
}

class LibraryOutput final : public Hdf5Output {
 public:
  explicit LibraryOutput(const std::string& path) : file_(create_file(path)) {}
  ~LibraryOutput() override { close(); }

  std::string add(const std::string& group_name, const Hdf5Array& array,
                  std::string_view bytes) override try {
    be_quiet();  // of this thread
    make_group(group_name);
    const Handle group = open_group(file_, group_name);
    const Handle type = type_to_store(array.number);
    const std::vector<hsize_t> sizes(array.shape.begin(), array.shape.end());
    const Handle space(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr),
                       H5Sclose, "make a shape");
    const Handle properties = properties_without_times(H5P_DATASET_CREATE);
    Handle dataset(
        H5Dcreate2(group, array.name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT),
        H5Dclose, "make an array");
    const bool is_written =
        bytes.empty() || H5Dwrite(dataset, type, kWhole, kWhole, H5P_DEFAULT, bytes.data()) >= 0;
    // Few numbers are written when the array is closed.
    if (!is_written || !dataset.close_now()) {
      throw Hdf5Error("libhdf5 cannot write " + group_name + "/" + array.name);
    }
    return "";
  } catch (const std::exception& error) {
    return give_up(error.what());
  }

  std::string add_mark(const std::string& text) override try {
    be_quiet();
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "make a type");
    H5Tset_size(type, text.size());
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "make a shape");
    const Handle mark(H5Acreate2(file_, kMark, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                      "make its mark");
    if (H5Awrite(mark, type, text.data()) < 0) throw Hdf5Error("libhdf5 cannot write its mark");
    return "";
  } catch (const std::exception& error) {
    return give_up(error.what());
  }

  std::string close() override try {
    if (file_ < 0) return "";
    be_quiet();
    if (H5Fflush(file_, H5F_SCOPE_GLOBAL) < 0 || !file_.close_now()) {
      throw Hdf5Error("libhdf5 cannot write all of it");
    }
    return "";
  } catch (const std::exception& error) {
    return give_up(error.what());
  }

 private:
  void make_group(const std::string& name) {
    if (H5Lexists(file_, name.c_str(), H5P_DEFAULT) > 0) return;
    const Handle properties = properties_without_times(H5P_GROUP_CREATE);
    const Handle made(H5Gcreate2(file_, name.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT),
                      H5Gclose, "make a group");
  }

  /// Leaves the file as it is: see Handle.
  std::string give_up(const std::string& why) {
    file_.leave_open();
    return why;
  }

  Handle file_;
};

std::string create(const std::string& path, std::unique_ptr<Hdf5Output>& output) try {
  output = std::make_unique<LibraryOutput>(path);
  return "";
} catch (const std::exception& error) {
  return error.what();
}

constexpr Hdf5Functions kFunctions = {list, read, create};

}  // namespace
}  // namespace mosbench

// dlsym finds the C name; both sides have the same types by its number, so C++ types may pass.
extern "C" __attribute__((visibility("default"))) const mosbench::Hdf5Functions*
mosbench_hdf5_functions_2() {
  // At the end of the process the library would close what it could not write, and crash.
  H5dont_atexit();
  return &mosbench::kFunctions;
}
