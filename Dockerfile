# furrow and its lineages: docker build -t furrow . && docker run --rm -v "$PWD:/work" furrow tree
FROM rust:1.89-slim-bookworm AS build
# hadolint ignore=DL3008
RUN apt-get update \
    && apt-get install --yes --no-install-recommends gcc libc6-dev \
    && rm -rf /var/lib/apt/lists/*
WORKDIR /source
COPY . .
RUN cargo install --path . --locked --features geff --root /furrow

FROM debian:bookworm-slim
COPY --from=build /furrow/bin/furrow /usr/local/bin/furrow
RUN useradd --uid 1000 --create-home furrow && mkdir /work && chown furrow /work
USER 1000
WORKDIR /work
ENTRYPOINT ["furrow"]
CMD ["--help"]
