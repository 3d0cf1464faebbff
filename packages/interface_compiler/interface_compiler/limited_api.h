// Included before the generated code that converts messages. It holds that code to the limited API of Python 3.10, so
// that what is compiled here loads into every later Python too: https://docs.python.org/3/c-api/stable.html
//
// The generators write for one version of Python: they use macros that look into objects. Each is defined here anew, by
// a function of the limited API.
#ifndef INTERFACE_COMPILER_LIMITED_API_H_
#define INTERFACE_COMPILER_LIMITED_API_H_

#define Py_LIMITED_API 0x030a0000
#include <Python.h>
#include <string.h>

// What PySequence_Fast returns is a list or a tuple. The item is borrowed, as the macro's is.
static inline PyObject * item_of(PyObject * sequence, Py_ssize_t index)
{
  return PyList_Check(sequence) ? PyList_GetItem(sequence, index) : PyTuple_GetItem(sequence, index);
}

// The name belongs to the object, as with the macro. The generated code reads on after it has released the object: a
// class and its module keep theirs.
#define PyUnicode_1BYTE_DATA(text) PyUnicode_AsUTF8AndSize(text, NULL)
#define PySequence_Fast_GET_ITEM(sequence, index) item_of(sequence, index)
#define PyBytes_AS_STRING(bytes) PyBytes_AsString(bytes)
#define PyFloat_AS_DOUBLE(number) PyFloat_AsDouble(number)

// Buffers are in the limited API from Python 3.11 on. Before that a copy of a buffer can be had, as bytes.
typedef struct
{
  PyObject * bytes;
  Py_ssize_t len;
} copied_buffer;

static inline int has_buffer(PyObject * object)
{
  if (PyList_Check(object) || PyTuple_Check(object)) {
    return 0;
  }
  PyObject * view = PyMemoryView_FromObject(object);
  if (!view) {
    PyErr_Clear();
    return 0;
  }
  Py_DECREF(view);
  return 1;
}

static inline int copy_buffer(PyObject * object, copied_buffer * buffer)
{
  buffer->bytes = PyBytes_FromObject(object);
  if (!buffer->bytes) {
    return -1;
  }
  buffer->len = PyBytes_Size(buffer->bytes);
  return 0;
}

static inline int read_buffer(void * target, copied_buffer * buffer)
{
  memcpy(target, PyBytes_AsString(buffer->bytes), buffer->len);
  return 0;
}

#undef PyBUF_SIMPLE
#define PyBUF_SIMPLE 0
#define Py_buffer copied_buffer
#define PyObject_CheckBuffer(object) has_buffer(object)
#define PyObject_GetBuffer(object, buffer, flags) copy_buffer(object, buffer)
#define PyBuffer_ToContiguous(target, buffer, size, order) read_buffer(target, buffer)
#define PyBuffer_Release(buffer) Py_DECREF((buffer)->bytes)

// Stands for a type's `tp_name`, which the generated code compares: "numpy.ndarray", "array.array".
static inline int is_named(PyObject * object, const char * full_name)
{
  PyObject * type = (PyObject *)Py_TYPE(object);
  PyObject * module = PyObject_GetAttrString(type, "__module__");
  PyObject * name = PyObject_GetAttrString(type, "__name__");
  PyObject * joined = module && name ? PyUnicode_FromFormat("%U.%U", module, name) : NULL;
  int same = joined && PyUnicode_CompareWithASCIIString(joined, full_name) == 0;
  Py_XDECREF(joined);
  Py_XDECREF(name);
  Py_XDECREF(module);
  PyErr_Clear();
  return same;
}

#endif  // INTERFACE_COMPILER_LIMITED_API_H_
