# The target docs: API pages of the public headers and the README pages, in BUILD/docs/html. Warnings
# are errors.
find_package(Doxygen 1.9 QUIET)
if(DOXYGEN_FOUND)
  file(GLOB pages RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS
       *.md core/*.md core/*/*.md datasets/*.md datasets/*/*.md eval/*.md eval/*/*.md results/*.md results/*/*.md
       docs/*.md docs/*/*.md docs/*/*/*.md bench/*.md scripts/*.md scripts/*/*.md tests/*.md tests/*/*.md)
  set(DOXYGEN_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/docs)
  set(DOXYGEN_USE_MDFILE_AS_MAINPAGE ${PROJECT_SOURCE_DIR}/README.md)
  set(DOXYGEN_STRIP_FROM_PATH ${PROJECT_SOURCE_DIR}/core/include ${PROJECT_SOURCE_DIR})
  set(DOXYGEN_STRIP_FROM_INC_PATH ${PROJECT_SOURCE_DIR}/core/include)
  set(DOXYGEN_IMAGE_PATH ${PROJECT_SOURCE_DIR}/results ${PROJECT_SOURCE_DIR}/docs/history/plus)
  set(DOXYGEN_HAVE_DOT NO)
  set(DOXYGEN_GENERATE_LATEX NO)
  set(DOXYGEN_QUIET YES)
  set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
  doxygen_add_docs(docs core/include/mosbench ${pages} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
                   COMMENT "Writing the API pages to ${PROJECT_BINARY_DIR}/docs/html")
endif()
