"""What an account is refused, in both languages; every refusal says what to do instead."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

__all__ = ["REFUSALS", "PeopleError"]

REFUSALS: Mapping[str, tuple[str, str]] = {  # key: zh, en
    "address": (
        "这不是电子邮箱地址，请写成 name@example.org 的形式。",
        "This is no e-mail address: write it as name@example.org.",
    ),
    "address-taken": (
        "这个邮箱已有账户，请登录；忘记密码可向前台索取一次性代码。",
        "There is an account with this address: sign in, or ask the desk for a one-time code.",
    ),
    "name": (
        "名字最多 {most} 个字，不能含控制字符。",
        "A name has at most {most} characters, and no control characters.",
    ),
    "password-short": (
        "密码至少 {least} 个字符；几个词连起来最好记。",
        "A password has at least {least} characters: a few words in a row are easy to keep.",
    ),
    "password-long": ("密码最多 {most} 个字符。", "A password has at most {most} characters."),
    "password-plain": (
        "这个密码太容易猜到：至少要有 {least} 个不同的字符，且不含邮箱名。",
        "This password is easily guessed: use at least {least} different characters, and not your address.",
    ),
    "password-wrong": ("密码不对，请再试一次。", "The password is wrong: try again."),
    "sign-in": (
        "邮箱、密码或验证码不对，请再试一次；忘记密码可向前台索取一次性代码。",
        "Address, password or authenticator code is wrong: try again, or ask the desk for a one-time code.",
    ),
    "no-office": (
        "这个账户没有工作人员角色，请联系管理员。",
        "This account has no role in the house: ask an administrator.",
    ),
    "too-often": (
        "尝试次数过多，请在 {seconds} 秒后再试。",
        "Too many attempts: try again in {seconds} seconds.",
    ),
    "code": (
        "代码不对、已用过或已过期，请向前台索取新的。",
        "The code is wrong, used or out of date: ask the desk for a new one.",
    ),
    "authenticator": (
        "验证码不对，请核对手机时间，输入最新的六位数字。",
        "The authenticator's code is wrong: check the phone's clock and give the newest six digits.",
    ),
    "present-factor": (
        "现用验证器的验证码不对，请输入它最新显示的六位数字，或一个恢复码。",
        "The code of the authenticator that is on is wrong: give its newest six digits, or a recovery code.",
    ),
    "no-account": (
        "没有这个邮箱的账户，请核对地址。",
        "There is no account with this address: check how it is written.",
    ),
    "account-closed": (
        "这个账户已关闭，代码无法使用；请先重新开放账户，或将其删除。",
        "This account is closed, and no code would open it: open it again first, or delete it.",
    ),
    "delete-confirm": (
        "请照抄邮箱以确认删除账户。",
        "Type the address of the account to confirm that it is to be deleted.",
    ),
    "no-session": (
        "没有这个登录会话，可能已经结束。",
        "There is no such session: it may have ended already.",
    ),
    "role": ("没有这个角色，请从 {roles} 中选择。", "There is no such role: choose one of {roles}."),
    "not-verified": (
        "这个账户由他人自行注册，邮箱未经确认：请先给本人一次性代码，用过之后再给角色。",
        "Whoever made this account never proved that the address is his: hand its owner a one-time code first, and "
        "give roles once it was used.",
    ),
    "last-administrator": (
        "这是最后一位管理员，请先任命另一位。",
        "This is the last administrator: name another one first.",
    ),
    "no-exhibit": (
        "没有这件展品，请从展品目录中选择。",
        "There is no such exhibit: choose one from the catalogue.",
    ),
    "favourites-full": (
        "收藏已满（{most} 件），请先移除一些。",
        "There are {most} favourites, which is all there is room for: take some out first.",
    ),
    "answer-code": (
        "这不是撤回码，请照抄提交问卷后所示的一串，形如 0b2c7e7e-8f0e-4e1c-9d0a-3f5b6a7c8d9e。",
        "This is no withdrawal code: copy the one that was shown after sending, such as "
        "0b2c7e7e-8f0e-4e1c-9d0a-3f5b6a7c8d9e.",
    ),
    "answer-consent": (
        "请先勾选同意：保存撤回码会把您的账户与这份回答连在一起。",
        "Tick the box first: a code that is kept links your account to these answers.",
    ),
    "no-answer": (
        "没有这个撤回码的回答，请核对撤回码。",
        "There are no answers of this code: check how it is written.",
    ),
    "answer-withdrawn": (
        "这份回答已被撤回，无需再保存撤回码。",
        "These answers were withdrawn already: there is no code left to keep.",
    ),
    "answer-frozen": (
        "这份回答已定稿用于评估，不能再撤回；您可以让账户忘记撤回码。",
        "These answers have been fixed for evaluation and can no longer be withdrawn; the account can forget the code.",
    ),
    "codes-full": (
        "账户已保存 {most} 个撤回码，请先忘记一些。",
        "The account keeps {most} codes, which is all there is room for: have it forget some first.",
    ),
    "no-occasion": (
        "没有这个场次，或已开始、已取消，请另选一场。",
        "There is no such date, or it has begun or been called off: choose another.",
    ),
    "booked-already": (
        "您已预约了这一场；要改人数，请先取消再预约。",
        "You are down for this date already: to change the number, cancel it first.",
    ),
    "party-size": (
        "人数须为 1 至 {most} 的整数。",
        "The number of people is a whole number from 1 to {most}.",
    ),
    "no-booking": (
        "没有这项预约，可能已取消。",
        "There is no such reservation: it may have been cancelled already.",
    ),
    "booking-cancelled": (
        "这次预约已取消；要重新预约，请再提交本页的表单。",
        "That reservation was cancelled: to book anew, send the form of this page.",
    ),
    "arrived": (
        "您已签到，不能再取消；如有误，请联系前台。",
        "You have been checked in, and this can no longer be cancelled: tell the desk if it is a mistake.",
    ),
    "occasion-over": (
        "此场已结束，预约不能再取消；如有误，请联系前台。",
        "It is over, and a reservation can no longer be cancelled: tell the desk if it is a mistake.",
    ),
    "occasion-slots": (
        "每段至少 5 分钟，一次最多 {most} 段。",
        "A slot has 5 minutes at least, and {most} slots are planned at once at most.",
    ),
    "no-suggestion": (
        "没有这条意见，可能已被撤回。",
        "There is no such suggestion: it may have been withdrawn.",
    ),
    "followup": (
        "状态须为 open、answered 或 done，说明最多 400 字。",
        "The state is open, answered or done, the note has 400 characters at most.",
    ),
    "token-label": (
        "请给令牌一个名称，最多 {most} 字。",
        "Give the token a label, {most} characters at most.",
    ),
    "no-token": (
        "没有这个令牌，可能已撤销。",
        "There is no such token: it may have been revoked already.",
    ),
    "signed-out": (
        "请先在 /office 登录。",
        "Sign in at /office first.",
    ),
    "occasion-times": (
        "请按 2026-12-05T14:00 的形式填写时间，结束须晚于开始。",
        "Write times as 2026-12-05T14:00, with the end after the beginning.",
    ),
    "occasion-far": (
        "时间须在 {first} 年至 {last} 年之间。",
        "Give times in the years from {first} to {last}.",
    ),
    "occasion-past": (
        "{when} 已经过去，请填写将来的时间。",
        "{when} is past: give a time to come.",
    ),
    "occasion-off": (
        "取消后不能恢复，已预约的人也不会自动得到通知：请先勾选确认。",
        "It cannot be put back, and whoever has booked is told nothing by itself: tick the box first.",
    ),
    "occasion-places": (
        "名额须为 {least} 至 1000 的整数，每次预约的人数不超过名额。",
        "Places are a whole number from {least} to 1000, and one booking is for no more than that.",
    ),
    "occasion-title": (
        "请用中文和英文各写一个标题，最多 120 字。",
        "Give a title in Chinese and in English, 120 characters each at most.",
    ),
    "occasion-text": (
        "说明最多 4000 字，地点最多 120 字，不含控制字符。",
        "A text has 4000 characters at most, a place 120, and no control characters.",
    ),
    "occasion-kind": (
        "类别须为 activity（活动）或 visit（参观）。",
        'The kind is "activity" or "visit".',
    ),
    "changed": (
        "{name} 在此期间已被改动。页面上并列两个版本，请合并后再保存。",
        "{name} was changed meanwhile. Put both versions together, which the page shows, and save again.",
    ),
    "occasion-changed": (
        "在您查看之后，此场已被他人改动。表中仍是您所写的；再保存一次，即以您的为准。",
        "Somebody changed this since you looked at it. The form keeps what you wrote: save once more to put it "
        "in place of theirs.",
    ),
    "undo-changed": (
        "{name} 此后又被改动，无法撤销；请先撤销较新的改动。",
        "{name} was changed again since, so this cannot be undone: undo the newer change first.",
    ),
    "draft-changed": (
        "草稿在您查看之后又被改动。下面是现在的草稿，请重新查看后再发布或放弃。",
        "The draft was changed since you looked at it. This is how it is now: look again, and publish or drop it then.",
    ),
    "no-draft": (
        "这件展品没有草稿，可能已经发布或放弃。",
        "This exhibit has no draft: it may have been published or dropped already.",
    ),
    "exhibit-id": (
        "名称须由小写字母、数字与连字符组成，最多 {most} 个字符，且不是保留名称。",
        "A name has a-z, 0-9 and hyphens, {most} characters at most, and is none of the reserved ones.",
    ),
    "exhibit-taken": ("已有同名展品，请另取名称。", "There is an exhibit of this name: choose another."),
    "content-check": (
        "展厅检查指出：{problems}",
        "The hall's check says: {problems}",
    ),
    "content-file": (
        "文件不能这样保存：{why}",
        "The file cannot be saved so: {why}",
    ),
    "content-write": (
        "文件写入失败（{why}），一切如旧；请检查磁盘。",
        "The files could not be written ({why}), and everything is as it was: check the disk.",
    ),
    "text-size": ("文字最多 {most} 字节，请缩短。", "A text has {most} bytes at most: shorten it."),
    "no-file": ("没有这个文件，请从列表中选择。", "There is no such file: choose one of the list."),
    "no-revision": ("没有这次改动的记录。", "There is no such change on record: choose one of the history."),
    "no-former": (
        "这次改动之前的文件已不在数据文件夹中，无法恢复。",
        "The files as they were before are no longer in the data folder, so this cannot be undone.",
    ),
    "no-upload": ("没有收到文件，请先选择。", "No file came: choose one first."),
    "file-size": (
        "{name} 过大：{kind}最多 {most} MB，请缩小后再上传。",
        "{name} is too large: a {kind} has {most} MB at most. Make it smaller and send it again.",
    ),
    "file-kind": (
        "{name}：无法识别内容。可用 JPEG、PNG、WebP、TIFF、SVG，GLB、PLY、OBJ，WebM、MP4、Ogg、MP3、WAV。",
        "{name}: its content is none of JPEG, PNG, WebP, TIFF, SVG; GLB, PLY, OBJ; WebM, MP4, Ogg, MP3, WAV.",
    ),
    "file-use": (
        "{name} 的内容是{kind}，不能用于此处，请换一项用途。",
        "{name} holds a {kind}, which cannot be used for this: choose another use.",
    ),
    "file-svg": (
        "{name} 含有 XML 实体，可能无限展开；请导出为普通 SVG（Plain SVG）。",
        "{name} declares XML entities, which may unfold without end: export it as plain SVG.",
    ),
    "file-svg-drawn": (
        "{name} 过于复杂：元素过多、嵌套过深、互相引用，或内嵌图片过多；请简化，或导出为 PNG。",
        "{name} draws too much: too many elements, nested too deeply, referring to each other in a circle, or too many "
        "pictures within. Make it simpler, or export it as PNG.",
    ),
    "file-archive": (
        "{name} 是压缩包，请解压后逐个上传。",
        "{name} is an archive: unpack it and send its files.",
    ),
    "file-broken": (
        "{name} 已损坏或不完整（{why}），请重新导出。",
        "{name} is broken or cut off ({why}): export it again.",
    ),
    "file-pixels": (
        "{name} 像素过多：最多 {most} 百万像素，请缩小。",
        "{name} has too many pixels, {most} million at most: scale it down.",
    ),
    "file-codec": (
        "{name} 的编码 {codec} 浏览器不能播放，此处也无法转换；请导出为 MP4（H.264、AAC）或 WebM。",
        "{name} holds {codec}, which browsers do not play and which is not converted here: "
        "export it as MP4 (H.264, AAC) or WebM.",
    ),
    "file-silent": (
        "{name} 没有声音；请另选文件，或作为影片上传。",
        "{name} holds no sound: choose another file, or bring it as a film.",
    ),
    "file-long": (
        "{name} 过长：{kind}最多 {most} 分钟，请剪短后再上传。",
        "{name} is too long: a {kind} lasts {most} minutes at most. Cut it and send it again.",
    ),
    "file-slow": (
        "{name} 未能在 {seconds} 秒内读完；请缩短或缩小，或导出为 MP4（H.264、AAC）。",
        "{name} could not be read within {seconds} s: make it shorter or smaller, or export it as MP4 (H.264, AAC).",
    ),
    "quota": (
        "草稿与历史已占满 {most} GB，请删去草稿，或由管理员以 --quota 增加。",
        "Drafts and history fill the {most} GB there are: drop a draft, or have an administrator raise --quota.",
    ),
    "no-bake": ("没有这项烘焙，可能已结束。", "There is no such bake: it may have ended already."),
    "no-backup": ("没有这个备份，请从列表中选择。", "There is no such backup: choose one of the list."),
    "backup-failed": ("备份未成：{why}", "The backup failed: {why}"),
    "restore-confirm": (
        "请照抄备份的名称以确认恢复。",
        "Type the name of the backup to confirm that it is to be restored.",
    ),
    "remove-confirm": (
        "请照抄名称以确认删除。",
        "Type the name of the house to confirm that it is to be removed.",
    ),
    "no-questionnaire": (
        "没有这份问卷，请从列表中选择。",
        "There is no such questionnaire: choose one of the list.",
    ),
    "survey-refused": ("问卷服务拒绝：{why}", "The questionnaires say: {why}"),
    "again-differs": ("两次输入的密码不一致，请重新输入。", "The two passwords differ: type both again."),
    "not-allowed": (
        "您的角色不能做这件事；此次尝试已记入审计。需要时请联系管理员。",
        "Your role does not allow this, and the attempt is on record: ask an administrator if you need it.",
    ),
    "form": (
        "这个表单已过期或来自其他网站，请重新打开本页再试。",
        "This form is out of date or comes from elsewhere: open the page again and repeat.",
    ),
    "form-size": (
        "提交的内容过大，请缩短后再试。",
        "What was sent is too large: shorten it and repeat.",
    ),
    "form-kind": (
        "提交的内容无法读取：请重新打开本页再试；程序须发送 JSON 对象，其值为文字、数字、true 或 false。",
        "What was sent cannot be read: open the page again and repeat; a program sends a JSON object whose values are "
        "texts, numbers, true or false.",
    ),
}


_MISSING = frozenset(
    {
        "no-account",
        "no-exhibit",
        "no-occasion",
        "no-draft",
        "no-file",
        "no-revision",
        "no-backup",
        "no-questionnaire",
        "no-booking",
        "no-bake",
        "no-token",
        "no-suggestion",
    }
)


_KINDS: Mapping[str, str] = {
    "picture": "图片",
    "drawing": "线图（SVG）",
    "model": "模型",
    "scan": "扫描",
    "film": "影片",
    "sound": "声音",
}


class PeopleError(ValueError):
    """A refusal of the table. Its text is English; `text("zh")` is the other."""

    def __init__(self, key: str, **figures: object) -> None:
        self.key, self.figures = key, figures
        super().__init__(self.text("en"))

    @property
    def missing(self) -> bool:
        """Whether what was asked for is not there: 404 where the address names it."""
        return self.key in _MISSING

    def text(self, language: str) -> str:
        zh, en = REFUSALS[self.key]
        told = {name: _told(name, value, language) for name, value in self.figures.items()}
        return (zh if language == "zh" else en).format(**told)


def _told(name: str, value: Any, language: str) -> object:
    """A figure in that language, where it is more than a number or a name. problems: `content.problems.Problems`."""
    if name == "problems":
        return value.text(language)
    if name == "why" and language == "zh":
        from hall_app.content.problems import in_language  # the content's loading comes with it

        return in_language(str(value), language)
    return _KINDS.get(str(value), value) if name == "kind" and language == "zh" else value
