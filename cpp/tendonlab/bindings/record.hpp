#pragma once
// A struct of facts as a read-only Python class: attributes, repr, ==, hash and pickle from one list of its fields.
#include <optional>
#include <set>

#include "tendonlab/bindings/words.hpp"

namespace tendonlab::bindings {
template <class Value>
py::object to_python(const Value& value) {
  return py::cast(value);
}
inline py::object to_python(const std::vector<std::string>& names) {
  return py::tuple(py::cast(names));
}
/// Views of texts that outlive the Python strings they came from: a pool that lives as long as the program.
inline std::string_view interned(const std::string& text) {
  static auto* pool = new std::set<std::string>;
  return *pool->insert(text).first;
}
template <class Value>
Value from_python(const py::handle& value) {
  if constexpr (std::is_same_v<Value, std::string_view>)
    return interned(value.cast<std::string>());
  else
    return value.cast<Value>();
}

/// One fact of a record. The value `absent` is None in Python.
template <class Record, class Value>
struct Field {
  const char* name;
  Value Record::*member;
  const char* meaning;
  std::optional<Value> absent = {};

  py::object get(const Record& of) const {
    const Value& value = of.*member;
    return absent && value == *absent ? py::object(py::none()) : to_python(value);
  }
  void set(Record& of, const py::handle& value) const {
    of.*member = value.is_none() ? *absent : from_python<Value>(value);
  }
};
template <class Record, class Value>
Field<Record, Value> field(const char* name, Value Record::*member, const char* meaning) {
  return {name, member, meaning, {}};
}
template <class Record, class Value, class Absent>
Field<Record, Value> field(const char* name, Value Record::*member, const char* meaning, Absent absent) {
  return {name, member, meaning, Value(absent)};
}

template <class Record, class... Values>
py::class_<Record> bind_record(py::module_& module, const char* name, const char* doc,
                               const Field<Record, Values>&... fields) {
  const auto values = [fields...](const Record& of) { return py::make_tuple(fields.get(of)...); };
  py::class_<Record> record(module, name, doc);
  (record.def_property_readonly(
       fields.name, [fields](const Record& of) { return fields.get(of); }, fields.meaning),
   ...);
  record
      .def("__repr__",
           [title = std::string(name), fields...](const Record& of) {
             std::string inside;
             ((inside += (inside.empty() ? "" : ", ") + std::string(fields.name) + "=" +
                         py::repr(fields.get(of)).template cast<std::string>()),
              ...);
             return title + "(" + inside + ")";
           })
      .def("__eq__",
           [values](const Record& of, const py::object& other) {
             return py::isinstance<Record>(other) && values(of).equal(values(other.cast<const Record&>()));
           })
      .def("__hash__", [values](const Record& of) { return py::hash(values(of)); })
      .def(py::pickle(values, [fields...](const py::tuple& state) {
        Record of{};
        std::size_t next = 0;
        (fields.set(of, state[next++]), ...);
        return of;
      }));
  return record;
}
}  // namespace tendonlab::bindings
